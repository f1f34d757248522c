#include "forcebound/client/session/late_force_policy.hpp"

#include <stdexcept>
#include <string>

namespace forcebound::client {

void LateForcePolicy::validate() const {
  if (hold < Nanoseconds::zero() || drop < hold) {
    const auto in_ms = [](Nanoseconds t) { return std::to_string(time::to_seconds(t) * 1e3) + " ms"; };
    throw std::invalid_argument("late-force policy must have 0 <= hold <= drop, got hold " + in_ms(hold) + ", drop " +
                                in_ms(drop));
  }
}

}  // namespace forcebound::client
