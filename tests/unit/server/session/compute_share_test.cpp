#include "forcebound/server/session/compute_share.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

/// A session at 1 kHz for so long, whose answers take so long each: how many were begun.
int answers(ComputeShare& share, time::Nanoseconds& now, time::Nanoseconds duration, time::Nanoseconds each) {
  int begun = 0;
  for (const auto end = now + duration; now < end; now += 1ms) {
    if (!share.may_answer(now)) continue;
    share.charge(each, now);
    ++begun;
  }
  return begun;
}

TEST(ComputeShare, AnswersAllWhereLessIsTakenThanAllowed) {
  time::Nanoseconds now{5s};
  ComputeShare share(0.5, now);
  EXPECT_EQ(answers(share, now, 10s, 400us), 10'000);
  EXPECT_NEAR(share.share(now), 0.4, 0.01);
}

TEST(ComputeShare, AnswersAsManyAsTheAllowedTimeIsEnoughFor) {
  time::Nanoseconds now{5s};
  ComputeShare share(0.5, now);
  EXPECT_NEAR(answers(share, now, 10s, 2ms), 2500, 30);
  EXPECT_NEAR(share.share(now), 0.5, 0.02);
}

TEST(ComputeShare, AnswersSometimesWhereOneAnswerTakesLongerThanTheBurst) {
  time::Nanoseconds now{5s};
  ComputeShare share(0.5, now);
  EXPECT_NEAR(answers(share, now, 60s, 1s), 30, 1);
}

TEST(ComputeShare, AllowsABurstAfterARest) {
  time::Nanoseconds now{5s};
  ComputeShare share(0.5, now);
  (void)answers(share, now, 10s, 2ms);
  now += 10s;
  EXPECT_NEAR(answers(share, now, 10ms, 2ms), 10, 1) << "10 ms of 2 ms each, from 50 ms that were saved";
  now += 20s;
  EXPECT_LT(share.share(now), 1e-6);
}

TEST(ComputeShare, IsNotMovedByAClockThatStandsStillOrGoesBack) {
  ComputeShare share(0.5, 5s);
  for (int i = 0; i < 100; ++i) share.charge(1ms, 5s);
  EXPECT_FALSE(share.may_answer(5s));
  EXPECT_FALSE(share.may_answer(4s));
}

}  // namespace
}  // namespace forcebound::server
