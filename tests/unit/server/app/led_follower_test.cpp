#include "forcebound/server/app/led_follower.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/server/robot/robot_kinds.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/driven_arm.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using enum control::FollowerState;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(ChangesOfState, AreToldInALineWithReasonAndTimes) {
  EXPECT_EQ(in_words({.from = waiting, .to = following, .lasted = 3210ms, .silent = 1ms}),
            "waiting -> following after 3.21 s");
  EXPECT_EQ(in_words({.from = following, .to = holding, .lasted = 12'400ms, .silent = 101ms}),
            "following -> holding after 12.4 s; the leader was last heard 101 ms ago");
  EXPECT_EQ(
      in_words(
          {.from = holding, .to = stopping, .lasted = 400ms, .silent = 501ms, .why_stopped = "the leader is silent"}),
      "holding -> stopping after 400 ms: the leader is silent; the leader was last heard 501 ms ago");
  EXPECT_EQ(in_words({.from = following, .to = stopping, .lasted = 2s, .why_stopped = "the leader has left"}),
            "following -> stopping after 2 s: the leader has left; nobody leads");
  EXPECT_EQ(in_words({.from = stopping, .to = stopped, .lasted = 62ms, .why_stopped = "the leader has left"}),
            "stopping -> stopped after 62 ms; it follows again once its leader engages");
  EXPECT_EQ(
      in_words({.from = following, .to = failed, .lasted = 1s, .silent = 1ms, .why_stopped = "the robot refuses"}),
      "following -> failed after 1 s: the robot refuses");
}

TEST(ChangesOfState, TellWhatTheRobotSaidWhereItEndedItsWork) {
  StateChange change{.from = following, .to = failed, .lasted = 1s, .why_stopped = "the robot refuses"};
  constexpr std::string_view kSaid = "joint 4 is too hot";
  std::ranges::copy(kSaid, change.robot_error.begin());
  EXPECT_EQ(in_words(change), "following -> failed after 1 s: the robot refuses: joint 4 is too hot");
  change.to = stopped;
  change.why_stopped = "the robot stopped by itself";
  EXPECT_EQ(in_words(change),
            "following -> stopped after 1 s: the robot stopped by itself: joint 4 is too hot; it follows again once "
            "its leader engages");
  change.from = failed;
  EXPECT_EQ(in_words(change), "failed -> stopped after 1 s; it follows again once its leader engages");
}

TEST(ChangesOfState, TellHowOldTheSensorsBiasIsAndWhetherTheGripperStays) {
  EXPECT_EQ(in_words({.from = stopped, .to = following, .lasted = 2s, .grip_waits = true, .bias_age = 90ms}),
            "stopped -> following after 2 s; its sensor's bias was learned 90 ms ago; the gripper stays until its "
            "leader's own grip has met where it stands");
}

TEST(TheSensorsBias, IsToldToBeLearnedOrWhyItIsNot) {
  using enum SensorBias::Answer;
  EXPECT_EQ(in_words(SensorBias::Status{.answer = learned, .off_N = 2.98}),
            "its sensor's bias is learned again, 2.98 N from before");
  EXPECT_THAT(in_words(SensorBias::Status{.answer = touches, .off_N = 5.2}),
              AllOf(HasSubstr("is not learned: the tool touches something"), HasSubstr("(5.2 N more than untouched)")));
  for (const auto answer : {no_sensor, no_samples, holds}) {
    EXPECT_THAT(in_words(SensorBias::Status{.answer = answer}), HasSubstr("is not learned: "));
  }
}

TEST(RobotsTotals, HaveBothTimersAndThePort) {
  FollowerThread::Outcome outcome;
  outcome.totals.ticks = 10'000;
  outcome.totals.bounded = 250;
  outcome.totals.audited = true;
  outcome.totals.port = {.energy_J = 0.0123, .minimum_J = -0.0};
  outcome.totals.received_J = 1.5;
  outcome.totals.stops = 1;
  outcome.totals.why_stopped = "the leader is silent";
  outcome.totals.lag_m_max = 0.0042;
  outcome.in_state[following] = 9s;
  outcome.in_state[waiting] = 1s;
  outcome.loop = {.wake_ups = 9999, .late = 2, .p50_us = 1000, .p99_us = 1043, .p999_us = 1100, .max_us = 1900};
  outcome.idle = {.wake_ups = 9999, .late = 1, .p50_us = 1000, .p99_us = 1021, .p999_us = 1100, .max_us = 1700};
  outcome.missed_ticks = 3;
  outcome.at_rest = true;
  const std::string text = in_words(outcome);
  EXPECT_THAT(
      text,
      HasSubstr(
          "least P and store 0 mJ, final 12.3 mJ; store at the start 0 mJ; received from the leader's law 1500 mJ"));
  EXPECT_THAT(text, HasSubstr("on 2.5 % of 10000 ticks"));
  EXPECT_THAT(text, HasSubstr("4.2 mm behind its leader at most"));
  EXPECT_THAT(text, HasSubstr("states: waiting 1 s, following 9 s\n"));
  EXPECT_THAT(text, HasSubstr("stops: 1, the last because the leader is silent; at the end at rest\n"));
  EXPECT_THAT(text, HasSubstr("period: 1000 us median, 1043 p99, 1900 max; 2 late, 3 missed\n"));
  EXPECT_THAT(text, HasSubstr("idle timer: 1000 us median, 1021 p99, 1700 max; 1 late\n"));
  EXPECT_THAT(text, Not(HasSubstr("faults")));
}

TEST(RobotsTotals, SayWhatIsWrong) {
  FollowerThread::Outcome outcome;
  outcome.totals.readings[control::ReadingStatus::future] = 1;
  outcome.allocations = 2;
  const std::string text = in_words(outcome);
  EXPECT_THAT(text, HasSubstr("not audited: this robot does not measure P"));
  EXPECT_THAT(text, HasSubstr("NOT AT REST"));
  EXPECT_THAT(text, HasSubstr("faults: 1 reading latched in the future: no force\n"));
  EXPECT_THAT(text, HasSubstr("faults: 2 allocations"));
}

FollowerOptions at(const std::string& task) { return {.robot = robot_names().front(), .task = task}; }

TEST(LedRobot, IsTheEnvironmentOfItsTask) {
  if (!has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  const time::SteadyClock clock;
  const auto robot = start_follower(at("stiff-wall"), baselines::shipped_laws(), clock, std::nullopt);
  const EnvironmentKind kind = robot->environment();
  EXPECT_EQ(kind.name, "stiff-wall");
  EXPECT_THAT(robot->summary(), AllOf(HasSubstr("reach-7"), HasSubstr("position-force"), HasSubstr("fba-exact")));
  EXPECT_EQ(kind.make({.device = "omni"}).simulated, robot->summary());
  robot->stop();
  EXPECT_THAT(robot->totals(), AllOf(HasSubstr("robot: reach-7 at stiff-wall"), HasSubstr("  task: "),
                                     HasSubstr("not reached"), HasSubstr("at the end at rest")));
  std::istringstream lines(text::wrapped(robot->totals(), 4));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(text::columns_of(line), text::kColumns) << line;
}

TEST(LedRobot, BehindADriverHasNoTaskButWorkOfItsOwn) {
  const time::SteadyClock clock;
  const auto robot = start_follower({.robot = "driver:" + test::robot_driver() + ":joints=7"},
                                    baselines::shipped_laws(), clock, std::nullopt);
  EXPECT_EQ(robot->summary(), "robot arm 7, position-force, law fba-exact") << "without the driver's settings";
  EXPECT_EQ(robot->environment().name, "robot");
  EXPECT_TRUE(robot->environment().accepts(3));
  EXPECT_FALSE(robot->environment().accepts(1));
  robot->stop();
  EXPECT_FALSE(robot->is_lost());
  EXPECT_THAT(robot->totals(), AllOf(HasSubstr("position-force"), HasSubstr("at the end at rest"),
                                     HasSubstr("least P and store"), Not(HasSubstr("  task: "))));
}

TEST(LedRobot, SaysWhatItNeedsWithoutMuJoCo) {
  if (has_simulated_robots()) GTEST_SKIP() << "built with MuJoCo";
  const time::SteadyClock clock;
  try {
    (void)start_follower(at("plug"), baselines::shipped_laws(), clock, std::nullopt);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("MuJoCo"), HasSubstr("libmujoco-dev")));
  }
}

TEST(RobotKinds, AreRefusedByNameWithTheNearest) {
  for (const std::string& name : robot_names()) EXPECT_EQ(find_robot(name).name, name);
  try {
    (void)find_robot("reach-6");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'reach-6'"), HasSubstr("did you mean 'reach-7'"),
                                    HasSubstr("driver:FILE.so, or the path of a .toml file")));
  }
}

}  // namespace
}  // namespace forcebound::server
