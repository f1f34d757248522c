#include "forcebound/client/session/late_force_policy.hpp"

#include <stdexcept>
#include <string>

#include "forcebound/text/numbers.hpp"

namespace forcebound::client {

void LateForcePolicy::validate() const {
  if (hold < Nanoseconds::zero() || drop < hold) {
    const auto in_ms = [](Nanoseconds t) { return text::rounded(time::to_seconds(t) * 1e3) + " ms"; };
    throw std::invalid_argument("must be 0 <= hold <= drop, got hold " + in_ms(hold) + ", drop " + in_ms(drop));
  }
}

}  // namespace forcebound::client
