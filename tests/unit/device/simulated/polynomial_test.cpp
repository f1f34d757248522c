#include "forcebound/device/simulated/polynomial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
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

TEST(Polynomial, LeastIsFoundSoonWhereAMotionBeginsAtRest) {
  // As the energy of a device at rest whose hand begins to move: from s^5 on, and so hardly above 0 for long.
  std::array<double, 56> c{};
  for (std::size_t k = 5; k < c.size(); ++k) c[k] = 1e-12 * std::pow(0.6, static_cast<double>(k));
  const auto took = [](auto work) {
    auto shortest = std::chrono::nanoseconds::max();
    for (int trial = 0; trial < 5; ++trial) {
      const auto begin = std::chrono::steady_clock::now();
      work();
      shortest = std::min<std::chrono::nanoseconds>(shortest, std::chrono::steady_clock::now() - begin);
    }
    return shortest;
  };
  double found = -1;
  const auto search = took([&] { found = least(c, 1, 0); });
  double sum = 0;
  const auto values = took([&] {
    for (int i = 0; i < 100'000; ++i) sum += value(c, 1e-5 * i);
  });
  EXPECT_EQ(found, 0);
  EXPECT_GT(sum, 0);
  EXPECT_LT(search, values) << "a few dozen values, not millions";
}

TEST(Polynomial, NotFiniteCoefficientsEndTheSearchAtOnce) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<double, 3> c = {1, nan, nan};
  EXPECT_FALSE(first_negative(c));
  EXPECT_EQ(least(c, 1, 2.0), 2.0);
}

}  // namespace
}  // namespace forcebound::device::polynomial
