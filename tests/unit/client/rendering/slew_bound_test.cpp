#include "forcebound/client/rendering/slew_bound.hpp"

#include <gtest/gtest.h>

#include "forcebound/client/rendering/swap_offset.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using test::vector_of;

TEST(SlewBound, LetsEverythingThroughUnlessAskedFor) {
  SlewBound none({});
  EXPECT_EQ(none.bound(vector_of({0}), 1e-3), vector_of({0}));
  EXPECT_EQ(none.bound(vector_of({1000}), 1e-3), vector_of({1000}));
  EXPECT_EQ(none.bounded(), 0U);
}

TEST(SlewBound, GoesTheWholeWayInStepsOfItsRateAndCountsThem) {
  SlewBound bound({.slew_per_s = 1000});
  (void)bound.bound(vector_of({0, 0}), 1e-3);
  EXPECT_TRUE(bound.bound(vector_of({3, 4}), 1e-3).isApprox(vector_of({0.6, 0.8})));
  for (int i = 0; i < 3; ++i) (void)bound.bound(vector_of({3, 4}), 1e-3);
  EXPECT_EQ(bound.bounded(), 4U);
  EXPECT_TRUE(bound.bound(vector_of({3, 4}), 1e-3).isApprox(vector_of({3, 4})));
  EXPECT_EQ(bound.bound(vector_of({3, 4.5}), 1e-3), vector_of({3, 4.5}));
  EXPECT_EQ(bound.bounded(), 4U);
}

TEST(SlewBound, StaysWhereItIsWhileTimeGoesBack) {
  SlewBound bound({.slew_per_s = 1000});
  (void)bound.bound(vector_of({2, 0}), 1e-3);
  EXPECT_EQ(bound.bound(vector_of({2, 0}), -1e-3), vector_of({2, 0}));
  EXPECT_EQ(bound.bound(vector_of({9, 0}), -1e-3), vector_of({2, 0}));
}

TEST(SlewBound, LosesNoTimeBeyondWhatTheDeviceShows) {
  SlewBound bound({.slew_per_s = 1000, .most = 5});
  (void)bound.bound(vector_of({1000, 0}), 1e-3);
  for (int i = 0; i < 1000; ++i) (void)bound.bound(vector_of({0, 1e6}), 1e-3);
  EXPECT_TRUE(bound.bound(vector_of({0, 0}), 1e-3).isApprox(vector_of({0, 4})));
}

TEST(SwapOffset, FadesWhatTheDeviceShowedAndNoMore) {
  SwapOffset swap(30);
  swap.swap(vector_of({1000}), vector_of({10}), 0ms);
  EXPECT_TRUE(swap.left_N(1, 0ms).isApprox(vector_of({20})));
  swap.swap(vector_of({0}), vector_of({-1e6}), 0ms);
  EXPECT_TRUE(swap.left_N(1, 0ms).isApprox(vector_of({30})));
}

TEST(SwapOffset, GoesOnWhereTheForceWasAndEndsAfterTenMilliseconds) {
  SwapOffset swap(30);
  EXPECT_EQ(swap.left_N(1, 0ms), vector_of({0}));
  swap.swap(vector_of({5}), vector_of({1}), 7ms);
  EXPECT_EQ(swap.left_N(1, 7ms), vector_of({4}));
  EXPECT_EQ(swap.left_N(1, 12ms), vector_of({2}));
  EXPECT_EQ(swap.left_N(1, 17ms), vector_of({0}));
  EXPECT_EQ(swap.left_N(1, 12ms), vector_of({0})) << "it is over";
}

}  // namespace
}  // namespace forcebound::client
