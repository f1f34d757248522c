#include "forcebound/client/app/late_force_log.hpp"

#include <gtest/gtest.h>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using Kind = Event::Kind;

class LateForceLogTest : public ::testing::Test {
 protected:
  std::optional<LateForceLog::Line> change(Kind kind, time::Nanoseconds now) {
    log.store({.kind = kind, .time = now});
    return log.take(now);
  }

  LateForceLog log;
};

TEST_F(LateForceLogTest, LogsTheChangesOfOneBlackoutAtOnce) {
  EXPECT_TRUE(change(Kind::force_fading, 10s));
  EXPECT_TRUE(change(Kind::force_dropped, 10750ms));
  const auto line = change(Kind::force_fresh, 10800ms);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->kind, Kind::force_fresh);
  EXPECT_EQ(line->left_out, 0U);
}

TEST_F(LateForceLogTest, TellsOneChangeASecondOfAFloodAndCountsTheOthers) {
  std::uint64_t told = 0;
  std::uint64_t left_out = 0;
  for (int ms = 0; ms < 20'000; ++ms) {
    if (const auto line = change(ms % 2 == 0 ? Kind::force_fading : Kind::force_fresh, ms * 1ms)) {
      ++told;
      left_out += line->left_out;
    }
  }
  EXPECT_NEAR(static_cast<double>(told), 22, 1);
  const auto rest = log.take_rest();
  ASSERT_TRUE(rest);
  EXPECT_EQ(told + left_out + 1 + rest->left_out, 20'000U);
}

TEST_F(LateForceLogTest, TellsTheLastChangeOfAFloodOnceItsSecondIsOver) {
  for (int i = 0; i < 9; ++i) change(Kind::force_fading, 10s + i * 1ms);
  EXPECT_FALSE(change(Kind::force_fresh, 10010ms));
  EXPECT_FALSE(log.take(10900ms));
  const auto line = log.take(11100ms);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->kind, Kind::force_fresh);
  EXPECT_EQ(line->left_out, 6U);
  EXPECT_FALSE(log.take(20s));
}

TEST_F(LateForceLogTest, LeavesEventsOfTheConnectionToOthers) {
  EXPECT_TRUE(LateForceLog::concerns(Kind::force_dropped));
  EXPECT_FALSE(LateForceLog::concerns(Kind::welcomed));
  EXPECT_FALSE(LateForceLog::concerns(Kind::server_left));
}

}  // namespace
}  // namespace forcebound::client
