#include "forcebound/client/session/clock_offset.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

/// A server whose clock is ahead, and drifts.
struct FarServer {
  Nanoseconds ahead{0};
  double drift = 0;

  [[nodiscard]] Nanoseconds clock(Nanoseconds device) const {
    return device + ahead + Nanoseconds{static_cast<std::int64_t>(drift * static_cast<double>(device.count()))};
  }
  [[nodiscard]] ClockOffset::Exchange exchange(Nanoseconds read, Nanoseconds up, Nanoseconds down) const {
    constexpr Nanoseconds kComputing = 100us;
    return {.read = read,
            .received = clock(read + up),
            .answered = clock(read + up + kComputing),
            .arrived = read + up + kComputing + down};
  }
};

TEST(ClockOffset, IsNotKnownBeforeAnAnswer) {
  const ClockOffset offset;
  EXPECT_FALSE(offset.known());
  EXPECT_EQ(offset.ahead(), 0ns);
  EXPECT_EQ(offset.uncertainty(1s), Nanoseconds::max());
}

TEST(ClockOffset, IsTheMiddleOfWaysOfTheSameLength) {
  ClockOffset offset;
  offset.update(FarServer{.ahead = 5s}.exchange(1s, 50ms, 50ms));
  EXPECT_EQ(offset.ahead(), 5s);
  EXPECT_EQ(offset.uncertainty(1s), 50ms);
}

TEST(ClockOffset, IsOffByHalfOfWhatOneWayIsLongerThanTheOtherAndSaysSo) {
  ClockOffset offset;
  offset.update(FarServer{.ahead = -3s}.exchange(10s, 30ms, 70ms));
  EXPECT_EQ(offset.ahead(), -3s - 20ms);
  EXPECT_EQ(offset.uncertainty(10s), 50ms);
}

TEST(ClockOffset, ComesFromTheLeastDelayOfEachWay) {
  ClockOffset offset;
  const FarServer server{.ahead = 1h};
  offset.update(server.exchange(1s, 10ms, 90ms));
  offset.update(server.exchange(1001ms, 80ms, 10ms));
  EXPECT_LT(std::chrono::abs(offset.ahead() - 1h), 10us);
  EXPECT_LT(offset.uncertainty(1100ms), 10ms + 50us);
}

TEST(ClockOffset, HoldsTheTruthWhileClocksDriftApartByLessThanItsBound) {
  for (const double drift : {1.5e-4, -1.5e-4}) {
    const FarServer server{.ahead = 100ms, .drift = drift};
    ClockOffset offset;
    std::mt19937_64 random(1);
    std::exponential_distribution<double> more_ms(1.0 / 10);
    const auto way = [&] { return 20ms + Nanoseconds{static_cast<std::int64_t>(1e6 * more_ms(random))}; };
    for (Nanoseconds now = 1s; now < 600s; now += 10ms) {
      const auto answer = server.exchange(now, way(), way());
      offset.update(answer);
      const Nanoseconds wrong = std::chrono::abs(offset.ahead() - (server.clock(answer.arrived) - answer.arrived));
      // The drift of one clock also counts while a datagram is on its way.
      ASSERT_LE(wrong, offset.uncertainty(answer.arrived) + 100us) << now.count() << ", drift " << drift;
    }
    EXPECT_LT(offset.uncertainty(600s), 23ms) << "of ways of 20 ms at the least";
  }
}

TEST(ClockOffset, IsLessSureTheLongerNothingCame) {
  ClockOffset offset;
  offset.update(FarServer{}.exchange(0s, 1ms, 1ms));
  EXPECT_NEAR(static_cast<double>((offset.uncertainty(10s) - offset.uncertainty(0s)).count()), 2e6, 2e4);
}

TEST(ClockOffset, BeginsAnewWhereAClockWasSet) {
  ClockOffset offset;
  offset.update(FarServer{.ahead = 1s}.exchange(1s, 5ms, 5ms));
  offset.update(FarServer{.ahead = 9s}.exchange(2s, 50ms, 50ms));
  EXPECT_EQ(offset.ahead(), 9s);
  EXPECT_EQ(offset.uncertainty(2s), 50ms);
  offset.forget();
  EXPECT_FALSE(offset.known());
}

TEST(ClockOffset, PassesOverTimesThatCannotBe) {
  ClockOffset offset;
  constexpr Nanoseconds kLast{std::numeric_limits<std::int64_t>::max()};
  constexpr Nanoseconds kFirst{std::numeric_limits<std::int64_t>::min()};
  offset.update({.read = 0s, .received = kLast, .answered = kLast, .arrived = 1s});
  offset.update({.read = 0s, .received = kFirst, .answered = kFirst, .arrived = 1s});
  offset.update({.read = 0s, .received = 5s, .answered = 8s, .arrived = 1s});  // longer than the round trip took
  EXPECT_FALSE(offset.known());
}

}  // namespace
}  // namespace forcebound::client
