#include "forcebound/client/session/outage_detector.hpp"

#include <gtest/gtest.h>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

/// Starts after 1000 answers without loss.
class OutageDetectorTest : public ::testing::Test {
 protected:
  OutageDetectorTest() {
    for (std::uint64_t n = 1; n <= 1000; ++n) detector.on_force(static_cast<int>(n) * 1ms, {7, n, n, n, n});
  }

  OutageDetector detector{250ms};
};

TEST_F(OutageDetectorTest, ReportsNoneWhileForcesArrive) {
  EXPECT_EQ(detector.longest(1s).duration, 0ns);
  EXPECT_EQ(detector.longest(1250ms).duration, 0ns) << "up to the hold time a force is as good as new";
}

TEST_F(OutageDetectorTest, ReportsNoneBeforeTheFirstForce) {
  OutageDetector fresh{250ms};
  fresh.on_bye(1h, {7, 10, 0, 0, 0}, OutageDetector::Bye::of_the_server);
  EXPECT_EQ(fresh.longest(1h).duration, 0ns);
}

TEST_F(OutageDetectorTest, CountsLostForcesByTheForceThatEndsIt) {
  detector.on_force(4s, {7, 4000, 4000, 4000, 1001});
  const record::Blackout blackout = detector.longest(4s);
  EXPECT_EQ(blackout.duration, 3s);
  EXPECT_TRUE(blackout.over && blackout.counted);
  EXPECT_EQ(blackout.motions, 2999U) << "without the one whose answer ended it";
  EXPECT_EQ(blackout.lost_up, 0U);
  EXPECT_EQ(blackout.answers, 2999U);
  EXPECT_EQ(blackout.lost_down, 2999U);
}

TEST_F(OutageDetectorTest, CountsLostMotionsByTheForceThatEndsIt) {
  detector.on_force(4s, {7, 4000, 1001, 1001, 1001});
  const record::Blackout blackout = detector.longest(4s);
  EXPECT_EQ(blackout.motions, 2999U);
  EXPECT_EQ(blackout.lost_up, 2999U);
  EXPECT_EQ(blackout.answers, 0U);
  EXPECT_EQ(blackout.lost_down, 0U);
}

TEST_F(OutageDetectorTest, CountsByTheServersByeIfNoForceFollows) {
  detector.on_bye(61s, {7, 61'000, 1000, 1000, 1000}, OutageDetector::Bye::of_the_server);
  detector.on_force(62s, {8, 61'500, 1, 1, 1});
  const record::Blackout blackout = detector.longest(62s);
  EXPECT_EQ(blackout.duration, 61s);
  EXPECT_TRUE(blackout.over && blackout.counted && blackout.server_left);
  EXPECT_EQ(blackout.motions, 60'000U);
  EXPECT_EQ(blackout.lost_up, 60'000U);
}

TEST_F(OutageDetectorTest, DoesNotTakeTheAnswerToOurByeForOneOfTheServers) {
  detector.on_bye(3s, {7, 3000, 3000, 3000, 1000}, OutageDetector::Bye::answers_ours);
  const record::Blackout blackout = detector.longest(3s);
  EXPECT_FALSE(blackout.over || blackout.server_left);
  EXPECT_TRUE(blackout.counted);
  EXPECT_EQ(blackout.lost_down, 2000U);
}

TEST_F(OutageDetectorTest, DoesNotCountDatagramsOnTheirWayAtAByeAsLost) {
  detector.on_bye(1010ms, {7, 1100, 1000, 1000, 1000}, OutageDetector::Bye::of_the_server);
  detector.on_force(3s, {8, 1200, 1, 1, 1});
  const record::Blackout blackout = detector.longest(3s);
  EXPECT_FALSE(blackout.counted);
  EXPECT_TRUE(blackout.server_left);
}

TEST_F(OutageDetectorTest, DoesNotCompareTheCountsOfTwoSessions) {
  detector.on_force(3s, {8, 3000, 5000, 5000, 1});
  EXPECT_TRUE(detector.longest(3s).over);
  EXPECT_FALSE(detector.longest(3s).counted);
  EXPECT_FALSE(detector.longest(3s).server_left);
}

TEST_F(OutageDetectorTest, ReportsTheLongestAlsoWhileItLasts) {
  detector.on_force(2s, {7, 2000, 2000, 2000, 1001});
  EXPECT_EQ(detector.longest(2500ms).duration, 1s) << "the present one is shorter";
  EXPECT_EQ(detector.longest(5s).duration, 3s);
  EXPECT_FALSE(detector.longest(5s).over);
  detector.on_force(2600ms, {7, 2600, 2600, 2600, 1601});
  EXPECT_EQ(detector.longest(2600ms).duration, 1s);
}

TEST_F(OutageDetectorTest, SurvivesCountsThatRunBackwards) {
  detector.on_force(3s, {7, 3000, 10, 10, 5000});
  EXPECT_EQ(detector.longest(3s).lost_up, 1999U);
  EXPECT_EQ(detector.longest(3s).answers, 0U);
  EXPECT_EQ(detector.longest(3s).lost_down, 0U);
}

TEST_F(OutageDetectorTest, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  detector.on_bye(2s, {7, 2000, 1000, 1000, 1000}, OutageDetector::Bye::of_the_server);
  detector.on_force(3s, {7, 3000, 2000, 2000, 1001});
  (void)detector.longest(4s);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
