#include "forcebound/server/session/exact_buckets.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

TEST(ExactBuckets, NobodySharesOne) {
  ExactBuckets buckets(100ms, 5);
  for (std::uint64_t who = 0; who < 1000; ++who) {
    int taken = 0;
    for (int i = 0; i < 20; ++i) taken += buckets.take(who, 0s) ? 1 : 0;
    ASSERT_EQ(taken, 5) << who;
  }
  EXPECT_TRUE(buckets.take(7, 100ms));
  EXPECT_FALSE(buckets.take(7, 100ms));
}

TEST(ExactBuckets, ForgetWhoTookNothingWhereRoomIsNeeded) {
  ExactBuckets buckets(100ms, 5, 10);
  for (std::uint64_t who = 0; who < 10; ++who) EXPECT_TRUE(buckets.take(who, 0s));
  EXPECT_FALSE(buckets.take(10, 100ms)) << "all have taken lately";
  EXPECT_TRUE(buckets.take(0, 400ms));
  EXPECT_TRUE(buckets.take(10, 500ms)) << "what the others took has come again";
  EXPECT_EQ(buckets.known(), 2U);
}

TEST(ExactBuckets, AreBoundedHoweverManyCome) {
  ExactBuckets buckets(100ms, 5, 100);
  for (std::uint64_t who = 0; who < 100'000; ++who) (void)buckets.take(who, who * 1ms);
  EXPECT_LE(buckets.known(), 100U + 1U);
}

}  // namespace
}  // namespace forcebound::server
