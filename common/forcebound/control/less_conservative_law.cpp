#include "forcebound/control/less_conservative_law.hpp"

namespace forcebound::control {

Vector LessConservativeLaw::bound(const Vector& request_N) noexcept {
  return ledger_.held().bounded(request_N, ledger_.energy_J());
}

bool LessConservativeLaw::allows(const Vector& force_N, double /*latency_s*/) const noexcept {
  return ledger_.held().affords(force_N, ledger_.energy_J());
}

}  // namespace forcebound::control
