#include "forcebound/time/token_bucket.hpp"

#include <gtest/gtest.h>

namespace forcebound::time {
namespace {

using std::chrono::milliseconds;

TEST(TokenBucket, AllowsABurstAndThenTheRate) {
  TokenBucket bucket(milliseconds{1}, 3, milliseconds{100});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(bucket.take(milliseconds{100}));
  EXPECT_FALSE(bucket.take(milliseconds{100}));
  EXPECT_TRUE(bucket.take(milliseconds{101}));
  EXPECT_FALSE(bucket.take(milliseconds{101}));
}

TEST(TokenBucket, SavesNoMoreThanItsBurst) {
  TokenBucket bucket(milliseconds{1}, 3, milliseconds{0});
  int taken = 0;
  while (bucket.take(std::chrono::hours{1})) ++taken;
  EXPECT_EQ(taken, 3);
}

TEST(TokenBucket, EarnsNothingFromAClockThatRunsBackwards) {
  TokenBucket bucket(milliseconds{1}, 1, milliseconds{100});
  EXPECT_TRUE(bucket.take(milliseconds{100}));
  EXPECT_FALSE(bucket.take(milliseconds{50}));
  EXPECT_TRUE(bucket.take(milliseconds{51}));
}

}  // namespace
}  // namespace forcebound::time
