#include "forcebound/device/choosing_time.hpp"

#include <gtest/gtest.h>

namespace forcebound::device {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kPeriod = 1ms;

TEST(ChoosingTime, AllowsTwentyMicrosecondsBeforeAnythingIsKnown) { EXPECT_EQ(ChoosingTime(kPeriod).allowed(), 20us); }

TEST(ChoosingTime, AllowsASlowMachineHalfAsMuchAgainAsItTakes) {
  ChoosingTime choosing(kPeriod);
  for (int i = 0; i < 100; ++i) choosing.add(80us);
  EXPECT_EQ(choosing.allowed(), 120us);
}

TEST(ChoosingTime, FollowsALongTickAtOnceAndForgetsIt) {
  ChoosingTime choosing(kPeriod);
  for (int i = 0; i < 10; ++i) choosing.add(2us);
  choosing.add(200us);
  EXPECT_EQ(choosing.allowed(), 300us);
  int ticks = 0;
  while (choosing.allowed() > 20us) {
    choosing.add(2us);
    ASSERT_LT(++ticks, 100);
  }
  EXPECT_GT(ticks, 30);
}

TEST(ChoosingTime, NeverAllowsMoreThanHalfAPeriodHoweverLongAStopWas) {
  ChoosingTime choosing(kPeriod);
  choosing.add(2s);
  EXPECT_EQ(choosing.allowed(), 500us);
  for (int i = 0; i < 100; ++i) choosing.add(2us);
  EXPECT_EQ(choosing.allowed(), 20us);
}

}  // namespace
}  // namespace forcebound::device
