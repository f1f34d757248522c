#include "tests/tools/lab/identification/run_guide.hpp"

#include "tests/tools/sim/draw.hpp"

namespace forcebound::lab::identification {

void run_in_virtual_time(client::commands::identify::Guide& guide, device::HapticDevice& device, double period_s,
                         std::uint64_t seed, double seconds_max) {
  sim::Draw draw(seed);
  constexpr double kLatestShare = 0.1;
  constexpr double kSlowestStep_s = 40e-6;  // from the reading to the command
  device.start();
  const time::Nanoseconds origin = std::chrono::seconds(1);
  const auto ticks = static_cast<std::uint64_t>(seconds_max / period_s);
  time::Nanoseconds now = origin;
  for (std::uint64_t tick = 0; tick < ticks && !guide.done(); ++tick) {
    now = origin + time::from_seconds((static_cast<double>(tick) + draw.number(0, kLatestShare)) * period_s);
    const device::Reading reading = device.read(now);
    const time::Nanoseconds commanded = now + draw.duration(5e-6, kSlowestStep_s);
    if (const auto force = guide.tick(reading, time::to_seconds(commanded))) device.apply(commanded, *force);
    if (const auto work = guide.take_work()) work();
    now = commanded;
  }
  device.stop(now);
}

}  // namespace forcebound::lab::identification
