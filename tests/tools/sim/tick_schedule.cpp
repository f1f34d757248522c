#include "tests/tools/sim/tick_schedule.hpp"

#include <algorithm>
#include <array>

namespace forcebound::sim {
namespace {

/// Measured over a minute of clock_nanosleep at 1 kHz under SCHED_FIFO, on a virtual machine with two shared cores that
/// was compiling: for each lateness, the share of wake-ups up to it.
struct Quantile {
  double share;
  double late_us;
};
constexpr std::array kMeasured{
    Quantile{0, 14},        Quantile{0.01, 18},     Quantile{0.1, 21},      Quantile{0.25, 28},
    Quantile{0.5, 40},      Quantile{0.75, 55},     Quantile{0.9, 67},      Quantile{0.95, 71},
    Quantile{0.99, 84},     Quantile{0.995, 178},   Quantile{0.998, 653},   Quantile{0.999, 922},
    Quantile{0.9995, 1124}, Quantile{0.9998, 1324}, Quantile{0.9999, 2104}, Quantile{1, 9222}};

}  // namespace

Nanoseconds TickSchedule::next_wake(Nanoseconds free) {
  due_ += period_;
  if (free > due_) due_ += (free - due_) / period_ * period_;
  return std::max(due_ + lateness(), free);
}

Nanoseconds TickSchedule::next_choosing() {
  if (timing_.choosing_max == Nanoseconds::zero()) return Nanoseconds::zero();
  return draw_.duration(0, time::to_seconds(timing_.choosing_max));
}

Nanoseconds TickSchedule::next_chosen(Nanoseconds commanded) {
  constexpr Nanoseconds kUsual = std::chrono::microseconds(5);
  if (commanded > kUsual && draw_.chance(0.02)) return draw_.duration(0, time::to_seconds(commanded));
  return std::max(commanded - kUsual, Nanoseconds::zero());
}

Nanoseconds TickSchedule::lateness() {
  Nanoseconds late{0};
  if (draw_.chance(timing_.late_share)) {
    late += draw_.duration(0, time::to_seconds(timing_.late_max));
  }
  if (timing_.measured) {
    const double drawn = draw_.share();
    const auto above = std::upper_bound(kMeasured.begin(), kMeasured.end() - 1, drawn,
                                        [](double value, const Quantile& quantile) { return value < quantile.share; });
    const Quantile low = *(above - 1);
    const double between = (drawn - low.share) / (above->share - low.share);
    late += time::from_seconds(1e-6 * (low.late_us + between * (above->late_us - low.late_us)));
  }
  return late;
}

}  // namespace forcebound::sim
