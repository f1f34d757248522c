#include "forcebound/client/commands/identify/live_guide.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/client/runtime/watchdog.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::client::commands::identify {
namespace {

struct Shown {
  std::mutex mutex{};
  double share = 0;
  std::string doing{};
  std::function<void()> work{};  ///< for the thread that shows it
  std::uint64_t stops = 0;       ///< by the watchdog
  bool done = false;
};

/// Sends zero on every way out.
class StoppedAtLast {
 public:
  StoppedAtLast(device::HapticDevice& device, const time::Clock& clock) : device_(device), clock_(clock) {}
  ~StoppedAtLast() { device_.stop(clock_.now()); }
  StoppedAtLast(const StoppedAtLast&) = delete;
  StoppedAtLast& operator=(const StoppedAtLast&) = delete;

 private:
  device::HapticDevice& device_;
  const time::Clock& clock_;
};

/// Without a tick, before the watchdog stops the device: the time that it holds a force, and two ticks at least.
time::Nanoseconds longest_pause(const control::DeviceFacts& facts, time::Nanoseconds period) {
  return std::max(time::from_seconds(facts.hold_s_max), 2 * period);
}

/// Never waits for whoever shows it.
void show(const Guide& guide, std::function<void()>& work, Shown& shown) {
  const std::unique_lock lock(shown.mutex, std::try_to_lock);
  if (!lock) return;
  if (work) shown.work = std::exchange(work, {});
  shown.share = guide.share();
  shown.doing = guide.doing();
}

void tick_until_done(Guide& guide, device::HapticDevice& device, time::Nanoseconds period,
                     const std::atomic<bool>& stop, Shown& shown) {
  const time::SteadyClock clock;
  std::optional<client::Watchdog> watchdog;
  if (!device.is_simulated()) watchdog.emplace(device, clock, longest_pause(device.facts(), period));
  const StoppedAtLast stopped(device, clock);
  time::PeriodicTimer timer(clock, period);
  constexpr std::uint64_t kTicksToShow = 100;
  std::function<void()> work;
  for (std::uint64_t tick = 0; !guide.done() && !stop; ++tick) {
    const time::Nanoseconds now = timer.wait();
    if (watchdog) watchdog->store_tick_time(now);
    const device::Reading read = device.read(now);
    const time::Nanoseconds commanded = clock.now();
    const device::Reading reading = device::usable_or_lost(read, device.facts(), now, commanded);
    if (const auto force = guide.tick(reading, time::to_seconds(commanded))) device.apply(commanded, *force);
    if (auto taken = guide.take_work()) work = std::move(taken);
    if (work || tick % kTicksToShow == 0) show(guide, work, shown);
  }
  if (!watchdog) return;
  watchdog->rest();
  shown.stops = watchdog->stops();
}

}  // namespace

std::uint64_t run_live(Guide& guide, device::HapticDevice& device, double period_s, const std::atomic<bool>& stop,
                       const std::function<void(double share, const std::string& doing)>& progress) {
  device.start();
  Shown shown;
  std::exception_ptr failure;
  {
    const std::jthread ticking([&] {
      (void)time::ask_for_real_time(client::kTickPriority);
      try {
        tick_until_done(guide, device, time::from_seconds(period_s), stop, shown);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(shown.mutex);
      shown.done = true;
    });
    for (bool done = false; !done;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      double share = 0;
      std::string doing;
      std::function<void()> work;
      {
        const std::lock_guard lock(shown.mutex);
        share = shown.share;
        doing = shown.doing;
        done = shown.done;
        work = std::exchange(shown.work, {});
      }
      if (!done) progress(share, doing);
      if (!done && work) work();
    }
  }
  if (failure) std::rethrow_exception(failure);
  return shown.stops;
}

}  // namespace forcebound::client::commands::identify
