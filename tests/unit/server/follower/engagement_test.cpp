#include "forcebound/server/follower/engagement.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using enum control::FollowerState;

/// A robot and its leader, a millisecond after the other.
class Scene {
 public:
  FollowerState pass(Nanoseconds duration) {
    for (Nanoseconds end = seen.now + duration; seen.now < end;) {
      seen.now += 1ms;
      if (seen.silent && silent_grows) *seen.silent += 1ms;
      engagement.update(seen);
      begins += engagement.begins() ? 1 : 0;
    }
    return engagement.state();
  }
  void follow() {
    seen.silent = 0ns;
    seen.leader_still = true;
    ASSERT_EQ(pass(400ms), following);
  }

  Engagement::Sample seen;
  bool silent_grows = false;
  int begins = 0;
  Engagement engagement{EngagementTimes{}};
};

TEST(Engagement, WaitsUntilALeaderWithoutButtonsIsStill) {
  Scene scene;
  EXPECT_EQ(scene.pass(2s), waiting) << "nobody leads";
  scene.seen.silent = 0ns;
  EXPECT_EQ(scene.pass(2s), waiting) << "it moves";
  scene.seen.leader_still = true;
  EXPECT_EQ(scene.pass(200ms), waiting);
  scene.seen.leader_still = false;
  scene.pass(1ms);
  scene.seen.leader_still = true;
  EXPECT_EQ(scene.pass(200ms), waiting) << "still again only since then";
  EXPECT_EQ(scene.pass(200ms), following);
  EXPECT_EQ(scene.begins, 1);
}

TEST(Engagement, ALeaderWithButtonsEngagesByPressAndRelease) {
  Scene scene;
  scene.seen = {.silent = 0ns, .has_buttons = true, .leader_still = true};
  EXPECT_EQ(scene.pass(2s), waiting);
  scene.seen.clutch_pressed = true;
  EXPECT_EQ(scene.pass(100ms), waiting);
  scene.seen.clutch_pressed = false;
  EXPECT_EQ(scene.pass(1ms), following);
}

TEST(Engagement, TheClutchHoldsAndBeginsAnew) {
  Scene scene;
  scene.follow();
  scene.seen.clutch_pressed = true;
  EXPECT_EQ(scene.pass(3s), clutched);
  scene.seen.clutch_pressed = false;
  EXPECT_EQ(scene.pass(1ms), following);
  EXPECT_EQ(scene.begins, 2) << "the offset is taken anew";
}

TEST(Engagement, HoldsThenStopsThenFollowsOnlyWhenBothAgree) {
  Scene scene;
  scene.follow();
  scene.silent_grows = true;
  EXPECT_EQ(scene.pass(100ms), following);
  EXPECT_EQ(scene.pass(5ms), holding);
  scene.silent_grows = false;
  scene.seen.silent = 0ns;
  EXPECT_EQ(scene.pass(1ms), following) << "heard again in time";
  EXPECT_EQ(scene.begins, 2);

  scene.silent_grows = true;
  EXPECT_EQ(scene.pass(510ms), stopping);
  EXPECT_EQ(scene.engagement.why_stopped(), "the leader is silent");
  EXPECT_EQ(scene.pass(1s), stopping) << "not at rest yet";
  scene.seen.robot_at_rest = true;
  EXPECT_EQ(scene.pass(1ms), stopped);
  scene.silent_grows = false;
  scene.seen.silent = 0ns;
  scene.seen.leader_still = false;
  EXPECT_EQ(scene.pass(5s), stopped) << "the operator has not engaged";
  scene.pass(1ms);
  scene.seen.leader_still = true;
  EXPECT_EQ(scene.pass(400ms), following);
}

TEST(Engagement, ADeviceThatNobodyMovesEngagesNothingAfterAStop) {
  Scene scene;
  scene.follow();
  scene.seen.exceeded = "the tool is too fast";
  scene.seen.robot_at_rest = true;
  scene.pass(2ms);
  scene.seen.exceeded = {};
  EXPECT_EQ(scene.pass(5s), stopped);
  scene.seen.leader_still = false;
  scene.pass(1ms);
  scene.seen.leader_still = true;
  scene.seen.exceeded = "the tool is too fast";
  EXPECT_EQ(scene.pass(1s), stopped) << "it still presses against what stopped it";
  scene.seen.exceeded = {};
  EXPECT_EQ(scene.pass(400ms), following);
}

TEST(Engagement, BeginsToFollowOnlyFromWhereTheRobotIsKnownToBe) {
  Scene scene;
  scene.seen = {.silent = 0ns, .leader_still = true, .reading_usable = false};
  EXPECT_EQ(scene.pass(1s), waiting);
  scene.seen.reading_usable = true;
  EXPECT_EQ(scene.pass(400ms), following);
  scene.seen.clutch_pressed = true;
  scene.pass(1ms);
  scene.seen.clutch_pressed = false;
  scene.seen.reading_usable = false;
  EXPECT_EQ(scene.pass(5ms), clutched);
  scene.seen.reading_usable = true;
  EXPECT_EQ(scene.pass(1ms), following);
  EXPECT_EQ(scene.begins, 2);
}

TEST(Engagement, ARobotThatStopsByItselfIsNotFollowing) {
  Scene scene;
  scene.follow();
  scene.seen.robot_stopped = true;
  EXPECT_EQ(scene.pass(1ms), stopped);
  EXPECT_EQ(scene.engagement.why_stopped(), "the robot stopped by itself");
}

TEST(Engagement, StopsAtALimitAndFailsWithTheRobot) {
  Scene scene;
  scene.follow();
  scene.seen.exceeded = "the tool is too fast";
  EXPECT_EQ(scene.pass(1ms), stopping);
  EXPECT_EQ(scene.engagement.why_stopped(), "the tool is too fast");
  scene.seen.robot_ready = false;
  EXPECT_EQ(scene.pass(1ms), failed);
  scene.seen.exceeded = {};
  scene.seen.robot_ready = true;
  EXPECT_EQ(scene.pass(1ms), stopped) << "it answers again, and waits for the operator";
}

TEST(Engagement, ALeaderWhoIsGoneStopsTheRobot) {
  Scene scene;
  scene.follow();
  scene.seen.silent.reset();
  EXPECT_EQ(scene.pass(1ms), stopping);
}

}  // namespace
}  // namespace forcebound::server
