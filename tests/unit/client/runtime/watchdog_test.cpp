#include "forcebound/client/runtime/watchdog.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>

#include "tests/support/becomes_true.hpp"

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

/// Stands still until it is set, and counts how often it is looked at.
class SetClock final : public time::Clock {
 public:
  [[nodiscard]] time::Nanoseconds now() const noexcept override {
    ++looks;
    return time::Nanoseconds{ns.load()};
  }
  void set(time::Nanoseconds to) { ns = to.count(); }
  std::atomic<std::int64_t> ns{time::Nanoseconds(1s).count()};
  mutable std::atomic<int> looks{0};
};

struct WatchdogTest : testing::Test {
  /// Until the watchdog has begun and ended a look: a first may have begun before, and a third shows the second's end.
  void let_it_look() const {
    const int before = clock.looks;
    EXPECT_TRUE(test::becomes_true([&] { return clock.looks >= before + 3; }));
  }

  SetClock clock;
  StoppableDevice device;
  Watchdog watchdog{device, clock, 4ms};
};

TEST_F(WatchdogTest, StopsADeviceWhoseTickDoesNotRunAnyMoreOnceForEachPause) {
  watchdog.store_tick_time(clock.now());
  clock.set(1s + 5ms);
  EXPECT_TRUE(test::becomes_true([&] { return device.stops == 1; }));
  let_it_look();
  EXPECT_EQ(device.stops, 1) << "it stands already";
  watchdog.store_tick_time(clock.now());
  clock.set(1s + 10ms);
  EXPECT_TRUE(test::becomes_true([&] { return watchdog.stops() == 2; }));
  EXPECT_EQ(device.stops, 2);
}

TEST_F(WatchdogTest, LeavesADeviceAloneThatHasNotTickedYetOrTicks) {
  clock.set(2s);
  let_it_look();
  EXPECT_EQ(device.stops, 0);
  watchdog.store_tick_time(clock.now());
  clock.set(2s + 4ms);
  let_it_look();
  EXPECT_EQ(device.stops, 0);
}

TEST_F(WatchdogTest, RestsAfterTheLastTick) {
  watchdog.store_tick_time(clock.now());
  watchdog.rest();
  clock.set(10s);
  let_it_look();
  EXPECT_EQ(device.stops, 0);
}

}  // namespace
}  // namespace forcebound::client
