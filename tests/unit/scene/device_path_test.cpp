#include "forcebound/scene/device_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::scene {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kBeat = 1ms;
constexpr double kSpeed_m_per_s = 0.1;

Point along_x(double x_m) { return {x_m, 0, 0}; }

/// A device at 1 kHz whose clock is ten hours behind, and a network to what plays its path.
class PlayedPath : public ::testing::Test {
 protected:
  /// Motion i arrives so long after its reading; a negative time: never.
  using Transit = std::function<Nanoseconds(int i)>;

  /// Plays until the i-th millisecond of the model's clock.
  void play_until(int end) {
    for (; now < end; ++now) {
      for (int i = std::max(0, now - kReach); i <= now; ++i) {
        const Nanoseconds took = transit(i);
        const Nanoseconds arrived = i * kBeat + took;
        if (took < 0ns || arrived <= (now - 1) * kBeat || arrived > now * kBeat) continue;
        path.receive({.position_m = place(i), .read = i * kBeat - 10h, .arrived = arrived, .buttons = buttons(i)});
      }
      if (!path.begun()) continue;
      const Point before_m = played.position_m;
      played = path.play(now * kBeat);
      step_m = (played.position_m - before_m).norm();
      fastest_m_per_s = std::max(fastest_m_per_s, begun ? step_m / time::to_seconds(kBeat) : 0.0);
      begun = true;
    }
  }

  /// How far the place played is behind that at which the device is now, of one that goes at kSpeed_m_per_s.
  [[nodiscard]] double late_s() const { return 1e-3 * (now - 1) - played.position_m.x() / kSpeed_m_per_s; }

  static constexpr int kReach = 200;
  Transit transit = [](int) { return 20ms; };
  std::function<Point(int i)> place = [](int i) { return along_x(1e-3 * kSpeed_m_per_s * i); };
  std::function<std::uint32_t(int i)> buttons = [](int) { return 0U; };
  DevicePath path;
  DevicePath::Place played;
  double step_m = 0;
  double fastest_m_per_s = 0;
  int now = 0;
  bool begun = false;
};

TEST_F(PlayedPath, BegunElsewhereItGoesToItsMotionsAtTheSpeedOfAJump) {
  path.place_at(along_x(-0.3));
  played.position_m = along_x(-0.3);
  begun = true;
  play_until(1000);
  EXPECT_LT(fastest_m_per_s, DevicePath::kEase_m_per_s + 2 * kSpeed_m_per_s);
  EXPECT_NEAR(late_s(), 0.021, 2e-3);
}

TEST_F(PlayedPath, ForgottenItBeginsWhereItsMotionsDo) {
  path.place_at(along_x(-0.3));
  path.forget();
  play_until(25);
  EXPECT_GT(played.position_m.x(), -0.01);
}

TEST_F(PlayedPath, AButtonIsPressedWhereOnItsPathTheDevicePressedIt) {
  // Some motions come after newer ones, and some of those about the press never.
  transit = [](int i) { return i > 490 && i < 500 ? -1ms : 20ms + (7 * i % 10) * 1ms; };
  buttons = [](int i) { return i >= 500 && i < 800 ? 5U : 0U; };
  for (int end = 400; end < 1200; ++end) {
    play_until(end);
    const double at = played.position_m.x() / (1e-3 * kSpeed_m_per_s);
    if (std::abs(at - 500) < 1 || std::abs(at - 800) < 1) continue;  // within a motion of the change
    ASSERT_EQ(played.buttons, at > 500 && at < 800 ? 5U : 0U) << at;
  }
  EXPECT_EQ(played.buttons, 0U);
}

/// Between 20 and 29 ms, so that most motions come after a newer one.
Nanoseconds jittered(int i) { return 20ms + (7 * i % 10) * 1ms; }

TEST_F(PlayedPath, IsEvenHoweverUnevenlyItsMotionsCome) {
  transit = jittered;
  play_until(3000);
  for (int i = 3000; i < 5000; ++i) {
    play_until(i);
    ASSERT_NEAR(step_m, 1e-3 * kSpeed_m_per_s, 1e-9) << i;
    ASSERT_NEAR(played.velocity_m_per_s.x(), kSpeed_m_per_s, 1e-9);
  }
  EXPECT_GT(late_s(), 0.020);
  EXPECT_LT(late_s(), 0.032) << "hardly later than the latest";
}

TEST_F(PlayedPath, IsHardlyLaterThanItsMotionsWhereTheseComeEvenly) {
  play_until(3000);
  EXPECT_NEAR(late_s(), 0.022, 1e-6) << "20 ms on the way, a period until the next one comes, and the margin";
}

TEST_F(PlayedPath, GoesFasterOrSlowerByATenthWhenTheDelayChanges) {
  // A route that takes 60 ms longer, and then the first one again.
  transit = [](int i) { return i < 2000 || i >= 5000 ? 20ms : 80ms; };
  play_until(1990);
  for (int i = 1990; i < 9000; ++i) {
    play_until(i);
    // What comes for 60 ms after the change is no motion at all: the path goes on by itself until then.
    const bool quiet = i > 2010 && i < 2300;
    if (!quiet) {
      ASSERT_LT(step_m, 1.25e-3 * kSpeed_m_per_s) << i;
      ASSERT_GT(step_m, 0.75e-3 * kSpeed_m_per_s) << i;
    }
    if (i == 4900) {
      EXPECT_NEAR(late_s(), 0.082, 1e-3);
    }
  }
  EXPECT_NEAR(late_s(), 0.022, 1e-3);
}

TEST_F(PlayedPath, IsStraightWhereMotionsWereLost) {
  transit = [](int i) { return i % 7 == 0 || i % 7 == 3 ? -1ms : Nanoseconds{20ms}; };
  play_until(3000);
  for (int i = 3000; i < 3100; ++i) {
    play_until(i);
    ASSERT_NEAR(step_m, 1e-3 * kSpeed_m_per_s, 1e-9) << i;
  }
}

TEST_F(PlayedPath, GoesOnForAMomentAndIsHeldWhenMotionsStop) {
  transit = [](int i) { return i < 1000 ? Nanoseconds{20ms} : -1ms; };
  play_until(1010);
  EXPECT_NEAR(played.velocity_m_per_s.x(), kSpeed_m_per_s, 1e-9);
  play_until(1200);
  EXPECT_LT(played.velocity_m_per_s.norm(), 1e-6);
  EXPECT_NEAR(played.position_m.x(), place(999).x() + kSpeed_m_per_s * DevicePath::kGoesOn_s, 1e-6);
}

TEST_F(PlayedPath, GoesToWhereTheDeviceIsAfterAnOutageWithoutABlow) {
  transit = [](int i) { return i < 1000 || i >= 4000 ? Nanoseconds{20ms} : -1ms; };
  place = [](int i) { return along_x(i < 1000 ? 0 : 0.1); };
  play_until(6000);
  EXPECT_LT(fastest_m_per_s, DevicePath::kEase_m_per_s + 0.1);
  EXPECT_NEAR(played.position_m.x(), 0.1, 1e-5);
}

TEST_F(PlayedPath, LeavesOutReadingsThatAreNotLaterThanTheNewest) {
  play_until(1000);
  for (const Nanoseconds read : {900ms, 950ms, 979ms})
    path.receive({.position_m = along_x(5), .read = read - 10h, .arrived = 1000ms});
  play_until(2000);
  EXPECT_LT(fastest_m_per_s, 1.2 * kSpeed_m_per_s);
}

TEST_F(PlayedPath, BeginsAnewWithTheClockOfADeviceThatWasSet) {
  play_until(1000);
  const double before_m = played.position_m.x();
  // An hour on, and then a day back.
  path.receive({.position_m = along_x(before_m), .read = -9h, .arrived = 1000ms});
  path.receive({.position_m = along_x(before_m), .read = -33h, .arrived = 1001ms});
  for (int i = 1; i <= 100; ++i) {
    const Nanoseconds moment = 1001ms + i * kBeat;
    path.receive({.position_m = along_x(before_m + 1e-4 * i), .read = -33h + i * kBeat, .arrived = moment});
    played = path.play(moment);
  }
  EXPECT_NEAR(played.position_m.x(), before_m + 0.01, 5e-4);
  EXPECT_LE(path.played_before(-33h + 100ms), 3ms);
  EXPECT_GT(path.played_before(-33h + 100ms), 0ms);
}

TEST_F(PlayedPath, StaysWithinBoundsWhateverADeviceSends) {
  constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::array<std::int64_t, 8> kTimes{kLeast, kMost, 0, 1, -1, kMost / 2, 900'000'000, 1};
  constexpr double kLargest = std::numeric_limits<double>::max();
  constexpr std::array<double, 5> kPlaces{kLargest, -kLargest, 0, 1e-300, 3};
  Point before_m = Point::Zero();
  for (int i = 0; i < 20'000; ++i) {
    const auto n = static_cast<std::size_t>(i);
    // Some of these times follow each other by a nanosecond, others by what a clock would.
    const std::int64_t read = n % 3 == 0 ? kTimes.at(n / 3 % kTimes.size()) : i * 1'000'000LL - i % 2;
    path.receive({.position_m = Point::Constant(kPlaces.at(n % kPlaces.size())),
                  .read = Nanoseconds{read},
                  .arrived = i * 100us});
    if (i % 10 != 0) continue;
    played = path.play(i * 100us);
    ASSERT_TRUE(played.position_m.allFinite() && played.velocity_m_per_s.allFinite()) << i;
    ASSERT_LE(played.velocity_m_per_s.norm(), 1.001 * DevicePath::kFast_m_per_s) << i;
    if (i > 0) {
      ASSERT_LE((played.position_m - before_m).norm(), 1.001e-3 * DevicePath::kFast_m_per_s) << i;
    }
    before_m = played.position_m;
    for (const std::int64_t time : kTimes)
      ASSERT_LE(std::abs(path.played_before(Nanoseconds{time}).count()), 1'000'000'000);
  }
}

TEST_F(PlayedPath, KeepsTheNewestOfMoreMotionsThanThereIsRoomFor) {
  for (int i = 0; i <= 2000; ++i) path.receive({.position_m = along_x(1e-4 * i), .read = i * 1us, .arrived = i * 1us});
  for (int i = 1; i <= 2000; ++i) played = path.play(2ms + i * kBeat);
  EXPECT_NEAR(played.position_m.x(), 0.2, 0.11) << "the last one, and on from it for a moment";
}

TEST_F(PlayedPath, IsPlayedWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  for (int i = 0; i < 2000; ++i) {
    path.receive({.position_m = along_x(1e-4 * i), .read = i * kBeat, .arrived = i * kBeat});
    played = path.play(i * kBeat);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::scene
