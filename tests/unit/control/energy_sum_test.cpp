#include "forcebound/control/energy_sum.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace forcebound::control {
namespace {

TEST(EnergySum, StartsAtZero) { EXPECT_EQ(EnergySum{}.value_J(), 0.0); }

TEST(EnergySum, KeepsNanojoulesBesideAThousandJoules) {
  EnergySum sum;
  sum.add(1e3);
  constexpr int kTerms = 1'000'000;
  for (int i = 0; i < kTerms; ++i) sum.add(1e-9);
  EXPECT_NEAR(sum.value_J() - 1e3, kTerms * 1e-9, 2e-13);  // the last bit of a double near 1e3
}

TEST(EnergySum, RemembersASmallTermAfterALargeOneHasGone) {
  EnergySum sum;
  for (const double term : {1.0, 1e100, 1.0, -1e100}) sum.add(term);
  EXPECT_EQ(sum.value_J(), 2.0);
}

TEST(EnergySum, AgreesWithLongDoubleOverRandomTerms) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> term(0, 1e-3);
  EnergySum sum;
  long double expected = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double energy_J = term(random);
    sum.add(energy_J);
    expected += energy_J;
  }
  EXPECT_NEAR(sum.value_J(), static_cast<double>(expected), 1e-15);
}

TEST(EnergySum, StaysANumberBeyondTheLargestThereIs) {
  constexpr double kMost = std::numeric_limits<double>::max();
  for (const double sign : {1.0, -1.0}) {
    EnergySum sum;
    for (int i = 0; i < 3; ++i) sum.add(sign * 0.9 * kMost);
    EXPECT_EQ(sum.value_J(), sign * kMost);
    sum.add(-sign * kMost);
    sum.add(1.0);
    EXPECT_EQ(sum.value_J(), 1.0);
  }
}

}  // namespace
}  // namespace forcebound::control
