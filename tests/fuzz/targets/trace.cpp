#include <sstream>

#include "tests/fuzz/input.hpp"
#include "tests/tools/netem/trace.hpp"

namespace forcebound::fuzz {

void fuzz_trace(Bytes bytes) {
  may_refuse([&] {
    std::istringstream text{std::string(text_of(bytes))};
    const netem::NetworkTrace trace = netem::read_trace(text, "trace.csv");
    const auto* const round_trips = std::get_if<netem::RttTrace>(&trace);
    if (round_trips == nullptr) return;
    for (const int time_ms : {0, 1, 100'000}) (void)round_trips->one_way_delay(std::chrono::milliseconds{time_ms});
  });
}

}  // namespace forcebound::fuzz
