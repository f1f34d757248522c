#include "forcebound/client/rendering/rate_limiter.hpp"

#include <gtest/gtest.h>

#include "forcebound/client/rendering/bumpless_transfer.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using test::vector_of;

TEST(RateLimiter, LetsEverythingThroughUnlessAskedFor) {
  RateLimiter none({});
  EXPECT_EQ(none.limit(vector_of({0}), 1e-3), vector_of({0}));
  EXPECT_EQ(none.limit(vector_of({1000}), 1e-3), vector_of({1000}));
  EXPECT_EQ(none.limited(), 0U);
}

TEST(RateLimiter, GoesTheWholeWayInStepsOfItsRateAndCountsThem) {
  RateLimiter limiter({.slew_per_s = 1000});
  (void)limiter.limit(vector_of({0, 0}), 1e-3);
  EXPECT_TRUE(limiter.limit(vector_of({3, 4}), 1e-3).isApprox(vector_of({0.6, 0.8})));
  for (int i = 0; i < 3; ++i) (void)limiter.limit(vector_of({3, 4}), 1e-3);
  EXPECT_EQ(limiter.limited(), 4U);
  EXPECT_TRUE(limiter.limit(vector_of({3, 4}), 1e-3).isApprox(vector_of({3, 4})));
  EXPECT_EQ(limiter.limit(vector_of({3, 4.5}), 1e-3), vector_of({3, 4.5}));
  EXPECT_EQ(limiter.limited(), 4U);
}

TEST(RateLimiter, StaysWhereItIsWhileTimeGoesBack) {
  RateLimiter limiter({.slew_per_s = 1000});
  (void)limiter.limit(vector_of({2, 0}), 1e-3);
  EXPECT_EQ(limiter.limit(vector_of({2, 0}), -1e-3), vector_of({2, 0}));
  EXPECT_EQ(limiter.limit(vector_of({9, 0}), -1e-3), vector_of({2, 0}));
}

TEST(RateLimiter, LosesNoTimeBeyondWhatTheDeviceShows) {
  RateLimiter limiter({.slew_per_s = 1000, .most = 5});
  (void)limiter.limit(vector_of({1000, 0}), 1e-3);
  for (int i = 0; i < 1000; ++i) (void)limiter.limit(vector_of({0, 1e6}), 1e-3);
  EXPECT_TRUE(limiter.limit(vector_of({0, 0}), 1e-3).isApprox(vector_of({0, 4})));
}

TEST(BumplessTransfer, FadesWhatTheDeviceShowedAndNoMore) {
  BumplessTransfer transfer(30);
  transfer.begin(vector_of({1000}), vector_of({10}), 0ms);
  EXPECT_TRUE(transfer.applied_to(vector_of({10}), 0ms).isApprox(vector_of({30})));
  transfer.begin(vector_of({0}), vector_of({-1e6}), 0ms);
  EXPECT_NEAR(transfer.applied_to(vector_of({-1e6}), 0ms)[0], 0, 1e-12) << "not all of it at once";
  EXPECT_NEAR(transfer.applied_to(vector_of({-1e6}), 5ms)[0], -15, 1e-12);
  EXPECT_EQ(transfer.applied_to(vector_of({-1e6}), 10ms), vector_of({-1e6}));
}

TEST(BumplessTransfer, GoesOnWhereTheForceWasAndEndsAfterTenMilliseconds) {
  BumplessTransfer transfer(30);
  EXPECT_EQ(transfer.applied_to(vector_of({1}), 0ms), vector_of({1}));
  transfer.begin(vector_of({5}), vector_of({1}), 7ms);
  EXPECT_EQ(transfer.applied_to(vector_of({1}), 7ms), vector_of({5}));
  EXPECT_EQ(transfer.applied_to(vector_of({1}), 12ms), vector_of({3}));
  EXPECT_EQ(transfer.applied_to(vector_of({1}), 17ms), vector_of({1}));
  EXPECT_EQ(transfer.applied_to(vector_of({1}), 12ms), vector_of({1})) << "it is over";
}

}  // namespace
}  // namespace forcebound::client
