#include "forcebound/client/commands/doctor/clock_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace forcebound::client::commands {
namespace {

using namespace std::chrono_literals;
using client::ClockOffset;
using time::Nanoseconds;

/// Exchanges each millisecond for 5 s with a server whose clock is an hour ahead and drifts; jitter of each way is
/// uniform up to `jitter`.
///
///     client == up: 3 ms + jitter ==> server, 100 us of work == down: 8 ms + jitter ==> client
std::vector<ClockOffset::Exchange> drifting(double drift_ppm, Nanoseconds jitter, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int64_t> extra(0, jitter.count());
  const auto by_server = [drift_ppm](Nanoseconds time) {
    return time + 1h + Nanoseconds{std::llround(1e-6 * drift_ppm * static_cast<double>(time.count()))};
  };
  std::vector<ClockOffset::Exchange> exchanges;
  exchanges.reserve(5000);
  for (int i = 0; i < 5000; ++i) {
    const Nanoseconds read = 1000h + i * 1ms;
    const Nanoseconds there = read + 3ms + Nanoseconds{extra(random)};
    const Nanoseconds back = there + 100us + 8ms + Nanoseconds{extra(random)};
    exchanges.push_back(
        {.read = read, .received = by_server(there), .answered = by_server(there + 100us), .arrived = back});
  }
  return exchanges;
}

TEST(ClockDrift, IsThatOfTheClocksWhereDelaysAreAlwaysTheSameHoweverUnequalTheyAre) {
  for (const double ppm : {-150.0, 0.0, 20.0, 5000.0}) {
    const auto drift = clock_drift(drifting(ppm, 0ns, 1));
    ASSERT_TRUE(drift);
    EXPECT_NEAR(drift->ppm, ppm, 0.02 + 1e-4 * std::abs(ppm));
    EXPECT_LT(drift->uncertain_ppm, 0.1 + 0.05 * std::abs(ppm));
  }
}

TEST(ClockDrift, IsOffByNoMoreThanItSaysBehindJitter) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const auto drift = clock_drift(drifting(40, 5ms, seed));
    ASSERT_TRUE(drift);
    EXPECT_NEAR(drift->ppm, 40, drift->uncertain_ppm);
    EXPECT_LT(drift->uncertain_ppm, 1000);
  }
}

TEST(ClockDrift, TakesMoreThanAMoment) {
  const auto exchanges = drifting(40, 0ns, 1);
  EXPECT_FALSE(clock_drift({}));
  EXPECT_FALSE(clock_drift(std::span(exchanges).first(1)));
  EXPECT_FALSE(clock_drift(std::span(exchanges).first(90))) << "within less than a tenth of a second";
  EXPECT_TRUE(clock_drift(std::span(exchanges).first(200)));
  const std::vector<ClockOffset::Exchange> ends{exchanges.front(), exchanges.front(), exchanges.back()};
  EXPECT_FALSE(clock_drift(ends)) << "of two times only";
}

}  // namespace
}  // namespace forcebound::client::commands
