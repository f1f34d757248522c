#include "tests/tools/lab/accuracy/round_trips.hpp"

#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/netem/netem_values.hpp"

namespace forcebound::lab {

std::vector<double> parse_round_trips_s(const std::vector<std::string>& times) {
  std::vector<double> round_trips_s;
  for (const std::string& time : times) {
    const bool is_bare = text::finite_number(time).has_value();
    try {
      round_trips_s.push_back(time::to_seconds(netem::parse_time(is_bare ? time + "ms" : time, "round trip")));
    } catch (const std::invalid_argument&) {
      throw std::invalid_argument("--rtt takes times such as 5ms, 0.02s or 500us, or bare milliseconds, got '" + time +
                                  "'");
    }
  }
  return round_trips_s;
}

}  // namespace forcebound::lab
