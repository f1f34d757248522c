#include "forcebound/client/runtime/watchdog.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

class StoppableDevice final : public device::HapticDevice {
 public:
  StoppableDevice() { facts_.damping = device::Matrix::Identity(1, 1); }
  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return facts_; }
  device::Reading read(time::Nanoseconds) noexcept override { return {}; }
  void apply(time::Nanoseconds, const device::Vector&) noexcept override {}
  void stop(time::Nanoseconds) noexcept override { ++stops; }
  [[nodiscard]] std::optional<time::Nanoseconds> released_at() const noexcept override { return std::nullopt; }

  std::atomic<int> stops{0};

 private:
  control::DeviceFacts facts_;
};

// Waits for what the other thread does, however long the machine takes for it.
template <class Condition>
void wait_until(Condition condition) {
  while (!condition()) std::this_thread::sleep_for(1ms);
}

/// Stands still until it is set.
class SetClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override { return time::Nanoseconds{ns.load()}; }
  void set(time::Nanoseconds to) { ns = to.count(); }
  std::atomic<std::int64_t> ns{time::Nanoseconds(1s).count()};
};

struct WatchdogTest : testing::Test {
  /// Long enough for a watchdog to look a few times.
  static void let_it_look() { std::this_thread::sleep_for(30ms); }

  SetClock clock;
  StoppableDevice device;
  Watchdog watchdog{device, clock, 4ms};
};

TEST_F(WatchdogTest, StopsADeviceWhoseTickDoesNotRunAnyMoreOnceForEachPause) {
  watchdog.note_tick(clock.now());
  clock.set(1s + 5ms);
  wait_until([&] { return device.stops == 1; });
  let_it_look();
  EXPECT_EQ(device.stops, 1) << "it stands already";
  watchdog.note_tick(clock.now());
  clock.set(1s + 10ms);
  wait_until([&] { return device.stops == 2; });
  EXPECT_EQ(watchdog.stops(), 2U);
}

TEST_F(WatchdogTest, LeavesADeviceAloneThatHasNotTickedYetOrTicks) {
  clock.set(2s);
  let_it_look();
  EXPECT_EQ(device.stops, 0);
  watchdog.note_tick(clock.now());
  clock.set(2s + 4ms);
  let_it_look();
  EXPECT_EQ(device.stops, 0);
}

TEST_F(WatchdogTest, RestsAfterTheLastTick) {
  watchdog.note_tick(clock.now());
  watchdog.rest();
  clock.set(10s);
  let_it_look();
  EXPECT_EQ(device.stops, 0);
}

}  // namespace
}  // namespace forcebound::client
