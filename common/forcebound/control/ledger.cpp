#include "forcebound/control/ledger.hpp"

#include <cmath>

#include "forcebound/control/assertion.hpp"

namespace forcebound::control {

void Ledger::credit(const Motion& motion) noexcept {
  FORCEBOUND_ASSERT(motion.damping != nullptr, "a motion that is credited says the damping at its end");
  FORCEBOUND_ASSERT(motion.position.rows() == held_.force().rows(), "a position has a row for each degree of freedom");
  // A clock that stands still, runs back or jumps out of range says nothing of how long the force was held. Where the
  // device was when it zeroed the force, no reading tells.
  if (!is_measurable(motion.interval_s)) {
    lose(motion.interval_s);
  } else if (motion.held_s < motion.interval_s) {
    lose(motion.held_s);
  }
  if (const auto d = held_.displacement(motion)) {
    // A reading as far away as a double can hold is a fault, not energy, and must not poison the sum.
    const double change_J = held_.dissipation_J(*d) - held_.force().dot(*d);
    energy_.add(std::isfinite(change_J) ? change_J : -held_.worst_case_J(motion.interval_s));
  }
  held_.begin(motion);
}

void Ledger::lose(double interval_s) noexcept {
  energy_.add(-held_.worst_case_J(interval_s));
  held_.lose();
}

}  // namespace forcebound::control
