#include "forcebound/control/ledger.hpp"

namespace forcebound::control {

void Ledger::credit(const Motion& motion) noexcept {
  if (const auto d = held_.displacement(motion)) energy_.add(held_.dissipation_J(*d) - held_.force().dot(*d));
  held_.begin(motion);
}

void Ledger::charge_worst_case(double interval_s) noexcept {
  energy_.add(-held_.worst_case_J(interval_s));
  held_.lose();
}

}  // namespace forcebound::control
