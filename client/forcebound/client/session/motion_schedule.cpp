#include "forcebound/client/session/motion_schedule.hpp"

#include <stdexcept>

#include "forcebound/text/numbers.hpp"

namespace forcebound::client {

SendRate parse_send_rate(const std::string& typed) {
  constexpr double kLeast_Hz = 10;
  if (typed == "auto") return {.as_needed = true};
  const auto rate_Hz = text::finite_number(typed);
  if (!rate_Hz || *rate_Hz < kLeast_Hz)
    throw std::invalid_argument("must be auto or a number >= 10, got '" + typed + "'");
  return {.most_Hz = *rate_Hz};
}

}  // namespace forcebound::client
