#include "forcebound/client/session/motion_schedule.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

constexpr double kNoModel = std::numeric_limits<double>::infinity();

int motions_in(MotionSchedule& schedule, int ticks) {
  int motions = 0;
  for (int i = 0; i < ticks; ++i) motions += schedule.is_due(i * 1ms) ? 1 : 0;
  return motions;
}

TEST(MotionSchedule, SendsOnEachTickUnlessSomethingElseIsAskedFor) {
  MotionSchedule schedule({}, 1ms);
  EXPECT_EQ(motions_in(schedule, 1000), 1000);
}

TEST(MotionSchedule, SendsAtTheRateThatIsAskedFor) {
  for (const int rate_Hz : {700, 500, 300, 250, 100, 20}) {
    MotionSchedule schedule({.most_Hz = static_cast<double>(rate_Hz)}, 1ms);
    EXPECT_EQ(motions_in(schedule, 1000), rate_Hz);
  }
}

TEST(MotionSchedule, BeginsAnewAfterAPauseAndWhereTheClockWentBack) {
  MotionSchedule schedule({.most_Hz = 100}, 1ms);
  EXPECT_TRUE(schedule.is_due(0ms));
  EXPECT_TRUE(schedule.is_due(57ms));
  EXPECT_FALSE(schedule.is_due(60ms)) << "what the pause left out is not made up for";
  EXPECT_TRUE(schedule.is_due(67ms));
  EXPECT_TRUE(schedule.is_due(1ms));
  EXPECT_FALSE(schedule.is_due(2ms));
}

TEST(ParseSendRate, TakesARateThatKeepsTheSessionAlive) {
  EXPECT_TRUE(parse_send_rate("auto").as_needed);
  EXPECT_EQ(parse_send_rate("20").most_Hz, 20);
  for (const char* const wrong : {"9.9", "0", "-1", "nan", "inf", "fast", ""}) {
    EXPECT_THAT([&] { (void)parse_send_rate(wrong); },
                testing::ThrowsMessage<std::invalid_argument>(
                    testing::StrEq("must be auto or a number >= 10, got '" + std::string(wrong) + "'")));
  }
}

TEST(MotionSchedule, LeavesOutNoTickWhereEachHasAMotionHoweverUnevenTheyAre) {
  MotionSchedule schedule({.most_Hz = 1000}, 1ms);
  EXPECT_TRUE(schedule.is_due(0ms));
  EXPECT_TRUE(schedule.is_due(1700us));
  EXPECT_TRUE(schedule.is_due(2ms));
}

TEST(MotionSchedule, SendsOnEachTickBeforeItIsKnownWhatIsNeeded) {
  MotionSchedule schedule({.as_needed = true}, 1ms);
  EXPECT_EQ(motions_in(schedule, 100), 100);
}

TEST(MotionSchedule, SendsRarelyWhereTheSceneAtTheClientIsAllThereIs) {
  MotionSchedule schedule({.as_needed = true}, 1ms);
  schedule.plan(
      {.server_parts = wire::ServerParts::none, .scene_runs = true, .radius_m = kNoModel, .speed_m_per_s = 1});
  EXPECT_EQ(motions_in(schedule, 1000), 20);
}

TEST(MotionSchedule, SendsOnEachTickWhereAForceIsHeld) {
  MotionSchedule schedule({.as_needed = true}, 1ms);
  schedule.plan({.server_parts = wire::ServerParts::held, .scene_runs = true, .radius_m = kNoModel});
  EXPECT_EQ(motions_in(schedule, 100), 100);
  schedule.plan({.server_parts = wire::ServerParts::none, .scene_runs = true, .radius_m = kNoModel});
  EXPECT_FALSE(schedule.is_due(100ms));
  schedule.plan({.server_parts = wire::ServerParts::none, .scene_runs = false, .radius_m = kNoModel});
  EXPECT_TRUE(schedule.is_due(101ms)) << "not all about the device has arrived";
}

TEST(MotionSchedule, SendsMoreOftenWhilePiecesAreToCome) {
  MotionSchedule schedule({.as_needed = true}, 1ms);
  schedule.plan(
      {.server_parts = wire::ServerParts::none, .scene_runs = true, .pieces_wanted = true, .radius_m = kNoModel});
  EXPECT_EQ(motions_in(schedule, 1000), 200);
}

TEST(MotionInterval, IsShortEnoughForTheDeviceToStayWhereTheModelsHold) {
  const auto interval = [](double radius_m, double speed_m_per_s) {
    return motion_interval({.server_parts = wire::ServerParts::modelled,
                            .scene_runs = true,
                            .radius_m = radius_m,
                            .speed_m_per_s = speed_m_per_s});
  };
  EXPECT_EQ(interval(0.02, 0), 10ms);
  EXPECT_EQ(interval(0.02, 0.1), 10ms);
  EXPECT_EQ(interval(0.004, 0.5), 2ms);
  EXPECT_EQ(interval(kNoModel, 1), 10ms);
  EXPECT_EQ(interval(0, 1), 0ms);
}

TEST(MotionInterval, IsShortEnoughForAnswersToStayFresherThanTheHoldTimeWhereOneIsLost) {
  const auto interval = [](wire::ServerParts parts, Nanoseconds hold, Nanoseconds round_trip) {
    return motion_interval(
        {.server_parts = parts, .scene_runs = true, .radius_m = kNoModel, .hold = hold, .round_trip = round_trip});
  };
  EXPECT_EQ(interval(wire::ServerParts::none, 250ms, 100ms), 50ms) << "there is time enough";
  EXPECT_EQ(interval(wire::ServerParts::none, 250ms, 190ms), 30ms);
  EXPECT_EQ(interval(wire::ServerParts::none, 30ms, 10ms), 10ms);
  EXPECT_EQ(interval(wire::ServerParts::modelled, 30ms, 20ms), 5ms);
  EXPECT_EQ(interval(wire::ServerParts::none, 30ms, 100ms), 3ms) << "none is fresh, whatever the rate";
  EXPECT_EQ(interval(wire::ServerParts::none, 30ms, -5ms), 15ms) << "an answer came before its question";
  EXPECT_EQ(interval(wire::ServerParts::none, 0ms, 10ms), 0ms);
}

}  // namespace
}  // namespace forcebound::client
