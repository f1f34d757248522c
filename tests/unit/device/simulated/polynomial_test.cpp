#include "forcebound/device/simulated/polynomial.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace forcebound::device::polynomial {
namespace {

TEST(Polynomial, FindsTheFirstOfSeveralRoots) {
  // (s - 0.25)(s - 0.5)(s - 0.75), negated so that it begins positive.
  const std::array<double, 4> c = {0.09375, -0.6875, 1.5, -1.0};
  ASSERT_TRUE(first_negative(c));
  EXPECT_NEAR(*first_negative(c), 0.25, 1e-14);
}

TEST(Polynomial, FindsADipThatEndsPositiveAgain) {
  const double depth = 1e-9;  // (s - 0.3)^2 - depth
  const std::array<double, 3> c = {0.09 - depth, -0.6, 1};
  ASSERT_TRUE(first_negative(c));
  EXPECT_NEAR(*first_negative(c), 0.3 - std::sqrt(depth), 1e-12);
}

TEST(Polynomial, ReportsNoRootWhereItStaysPositive) {
  const std::array<double, 3> c = {0.09 + 1e-9, -0.6, 1};
  EXPECT_FALSE(first_negative(c));
}

TEST(Polynomial, LeastFindsAnInteriorMinimum) {
  const std::array<double, 3> c = {0.09, -0.6, 1};  // (s - 0.3)^2
  EXPECT_NEAR(least(c, 1, 1e9), 0, 1e-16);
}

TEST(Polynomial, LeastRespectsTheEndAndTheFloor) {
  const std::array<double, 3> c = {0.09, -0.6, 1};
  EXPECT_NEAR(least(c, 0.2, 1e9), 0.01, 1e-16);
  EXPECT_EQ(least(c, 1, -5), -5);
}

TEST(Polynomial, NotFiniteCoefficientsEndTheSearchAtOnce) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, 3> c = {1, nan, nan};
  EXPECT_FALSE(first_negative(c));
  EXPECT_EQ(least(c, 1, 2.0), 2.0);
}

}  // namespace
}  // namespace forcebound::device::polynomial
