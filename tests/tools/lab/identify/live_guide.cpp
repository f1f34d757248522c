#include "tests/tools/lab/identify/live_guide.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/client/runtime/watchdog.hpp"
#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::lab::identify {
namespace {

struct Shown {
  std::mutex mutex{};
  double share = 0;
  std::string doing{};
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

void tick_until_done(Guide& guide, device::HapticDevice& device, time::Nanoseconds period,
                     const std::atomic<bool>& stop, Shown& shown) {
  const time::SteadyClock clock;
  std::optional<client::Watchdog> watchdog;
  constexpr time::Nanoseconds kUnwatched = std::chrono::milliseconds(20);
  if (!device.is_simulated()) watchdog.emplace(device, clock, std::max(kUnwatched, 4 * period));
  const StoppedAtLast stopped(device, clock);
  time::PeriodicTimer timer(clock, period);
  constexpr std::uint64_t kTicksToShow = 100;
  for (std::uint64_t tick = 0; !guide.done() && !stop; ++tick) {
    const time::Nanoseconds now = timer.wait();
    if (watchdog) watchdog->note_tick(now);
    const device::Reading reading = device.read(now);
    const time::Nanoseconds commanded = clock.now();
    if (const auto force = guide.tick(reading, time::to_seconds(commanded))) device.apply(commanded, *force);
    if (tick % kTicksToShow != 0) continue;
    const std::unique_lock lock(shown.mutex, std::try_to_lock);
    if (!lock) continue;
    shown.share = guide.share();
    shown.doing = guide.doing();
  }
  if (watchdog) watchdog->rest();
}

}  // namespace

void run_live(Guide& guide, device::HapticDevice& device, double period_s, const std::atomic<bool>& stop,
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
      {
        const std::lock_guard lock(shown.mutex);
        share = shown.share;
        doing = shown.doing;
        done = shown.done;
      }
      if (!done) progress(share, doing);
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace forcebound::lab::identify
