#include "forcebound/client/commands/doctor/network_findings.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace forcebound::client::commands {
namespace {

using namespace std::chrono_literals;

TEST(Delays, AreNearestRanks) {
  std::vector<double> values_ms(1000);
  std::iota(values_ms.rbegin(), values_ms.rend(), 1.0);  // 1000, 999, ..., 1
  const Delays delays = delays_of(values_ms);
  EXPECT_EQ(delays.count, 1000U);
  EXPECT_EQ(delays.p50_ms, 500.5);
  EXPECT_EQ(delays.p90_ms, 900);
  EXPECT_EQ(delays.p99_ms, 990);
  EXPECT_EQ(delays.p999_ms, 999);
  EXPECT_EQ(delays.max_ms, 1000);
}

TEST(Delays, OfNothingAreNone) { EXPECT_EQ(delays_of({}).count, 0U); }

TEST(NetworkFindings, TellTheWaysApart) {
  const client::ForceStream::Counts counts{.sent = 1000,
                                           .received = 850,
                                           .duplicated = 3,
                                           .reordered = 7,
                                           .lost_up = 100,
                                           .lost_down = 40,
                                           .unanswered = 10,
                                           .motions_duplicated = 5,
                                           .motions_reordered = 11};
  const NetworkFindings found = network_findings({}, counts, 300ms);
  EXPECT_EQ(found.up.sent, 1000U);
  EXPECT_EQ(found.up.lost, 100U);
  EXPECT_DOUBLE_EQ(found.up.loss(), 0.1);
  EXPECT_EQ(found.up.reordered, 11U);
  EXPECT_EQ(found.up.duplicated, 5U);
  EXPECT_EQ(found.down.sent, 890U) << "the server answers only what it has received";
  EXPECT_EQ(found.down.lost, 40U);
  EXPECT_DOUBLE_EQ(found.down.loss(), 40.0 / 890);
  EXPECT_EQ(found.down.reordered, 7U);
  EXPECT_EQ(found.down.duplicated, 3U);
  EXPECT_EQ(found.unanswered, 10U);
  EXPECT_DOUBLE_EQ(found.longest_gap_ms, 300);
  EXPECT_EQ(found.round_trip.count, 0U);
  EXPECT_FALSE(found.drift);
}

TEST(NetworkFindings, CountNoMotionAsLostThatMayStillBeOnItsWay) {
  const client::ForceStream::Counts counts{.sent = 100, .received = 90, .lost_up = 10, .in_flight = 4};
  const NetworkFindings found = network_findings({}, counts, 0ms);
  EXPECT_EQ(found.up.sent, 96U);
  EXPECT_EQ(found.up.lost, 6U);
}

TEST(NetworkFindings, OfNothingSentHaveNoLoss) {
  const NetworkFindings found = network_findings({}, {}, 0ms);
  EXPECT_EQ(found.up.loss(), 0);
  EXPECT_EQ(found.down.loss(), 0);
}

TEST(NetworkFindings, SeeOnWhichWayDelaysVaryWhateverTheClocks) {
  // Up takes 5 ms, and each tenth motion 25 ms; down takes 50 ms. The server's clock is 9 h ahead.
  std::vector<AnsweredMotion> answers;
  answers.reserve(1000);
  for (int i = 0; i < 1000; ++i) {
    const Nanoseconds read = 1s + i * 1ms;
    const Nanoseconds there = read + (i % 10 == 3 ? 25ms : 5ms);
    answers.push_back(
        {.motion = static_cast<std::uint64_t>(i) + 1,
         .times = {
             .read = read, .received = there + 9h, .answered = there + 9h + 200us, .arrived = there + 200us + 50ms}});
  }
  const NetworkFindings found = network_findings(answers, {.sent = 1000, .received = 1000}, 21ms);
  EXPECT_NEAR(found.round_trip.p50_ms, 55.2, 1e-6);
  EXPECT_NEAR(found.round_trip.p99_ms, 75.2, 1e-6);
  EXPECT_NEAR(found.at_server.p50_ms, 0.2, 1e-6);
  EXPECT_NEAR(found.up.above_least.p50_ms, 0, 1e-6);
  EXPECT_NEAR(found.up.above_least.p99_ms, 20, 1e-6);
  EXPECT_NEAR(found.down.above_least.max_ms, 0, 1e-6);
  ASSERT_TRUE(found.drift);
  EXPECT_NEAR(found.drift->ppm, 0, 0.01);
}

TEST(NetworkFindings, TakeADriftOfTheClocksForNoVaryingDelay) {
  std::vector<AnsweredMotion> answers;
  answers.reserve(5000);
  for (int i = 0; i < 5000; ++i) {
    const Nanoseconds read = i * 1ms;
    const Nanoseconds there = read + 5ms + i * 1us;  // the server's clock gains 1000 ppm
    answers.push_back(
        {.motion = 1, .times = {.read = read, .received = there, .answered = there, .arrived = read + 10ms}});
  }
  const NetworkFindings found = network_findings(answers, {.sent = 5000, .received = 5000}, 1ms);
  ASSERT_TRUE(found.drift);
  EXPECT_NEAR(found.drift->ppm, 1000, 2);
  EXPECT_LT(found.up.above_least.max_ms, 0.05) << "5 ms with the drift";
  EXPECT_LT(found.down.above_least.max_ms, 0.05);
}

}  // namespace
}  // namespace forcebound::client::commands
