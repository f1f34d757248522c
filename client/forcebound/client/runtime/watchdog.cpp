#include "forcebound/client/runtime/watchdog.hpp"

#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/time/real_time.hpp"

namespace forcebound::client {
namespace {

constexpr int kLooksInLimit = 4;

}  // namespace

Watchdog::Watchdog(device::HapticDevice& device, const time::Clock& clock, time::Nanoseconds limit)
    : device_(device),
      clock_(clock),
      limit_(limit),
      thread_([this](const std::stop_token& stopping) { run(stopping); }) {}

void Watchdog::run(const std::stop_token& stopping) {
  time::ask_for_real_time(kWatchdogPriority);
  std::int64_t stopped_after = 0;
  while (!stopping.stop_requested()) {
    std::this_thread::sleep_for(limit_ / kLooksInLimit);
    const std::int64_t ticked = ticked_.load(std::memory_order_relaxed);
    const time::Nanoseconds now = clock_.now();
    if (ticked == 0 || ticked == stopped_after || now.count() - ticked <= limit_.count()) continue;
    stopping_ = true;
    device_.stop(now);
    stopping_ = false;
    stopped_after = ticked;
    ++stops_;
  }
}

}  // namespace forcebound::client
