#include "tests/tools/lab/accuracy/richardson.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/vector_of.hpp"

namespace forcebound::lab {
namespace {

using test::vector_of;
using testing::HasSubstr;

constexpr Spacings kHalved{4, 2, 1};

/// Forces that err by C h^p from (1, 2, 3) + i.
Forces level(double spacing, double order) {
  Forces forces;
  for (int i = 0; i < 20; ++i) {
    const double error = 0.1 * (1 + 0.1 * i) * std::pow(spacing, order);
    forces.push_back(vector_of({1.0 + i + error, 2.0 - error, 3.0}));
  }
  return forces;
}

TEST(Richardson, FindsTheOrderAndTheLimit) {
  for (const double order : {1.0, 2.0, 1.6}) {
    for (const Spacings& h : {Spacings{4, 2, 1}, Spacings{2.25, 1.5, 1}, Spacings{2, 4.0 / 3, 1}}) {
      const Extrapolation found = richardson(level(h[0], order), level(h[1], order), level(h[2], order), h);
      EXPECT_NEAR(found.order, order, 1e-9);
      EXPECT_LT(rms_difference(found.forces, level(0, order)), 1e-12);
      EXPECT_NEAR(found.uncertainty * rms(found.forces),
                  std::max(rms_difference(level(0, order), level(h[2], order)),
                           rms_difference(level(h[1], order), level(h[2], order))),
                  1e-12);
      EXPECT_THAT(found.why, HasSubstr("observed order"));
    }
  }
}

TEST(Richardson, RefusesLevelsThatGoApart) {
  const Extrapolation found = richardson(level(1, 1), level(2, 1), level(4, 1), kHalved);
  EXPECT_EQ(found.order, 0);
  EXPECT_EQ(rms_difference(found.forces, level(4, 1)), 0);
  EXPECT_THAT(found.why, HasSubstr("do not converge monotonically"));
  EXPECT_GT(found.uncertainty, 0);
}

TEST(Richardson, RefusesLevelsThatGoToAndFro) {
  const Extrapolation found = richardson(level(4, 1), level(0, 1), level(2, 1), kHalved);
  EXPECT_EQ(found.order, 0);
  EXPECT_THAT(found.why, HasSubstr("do not converge monotonically"));
}

// A point that presses into an elastic continuum sinks in the deeper the finer the mesh: its force tends to nothing.
TEST(Richardson, DoesNotExtrapolateToALimitFarAway) {
  const auto point = [](double spacing) { return Forces(10, vector_of({std::pow(spacing, 0.7), 0, 0})); };
  const Extrapolation found = richardson(point(4), point(2), point(1), kHalved);
  EXPECT_EQ(rms_difference(found.forces, point(1)), 0);
  EXPECT_GT(found.uncertainty, 0.9);
  EXPECT_THAT(found.why, HasSubstr("does the force of this contact have a limit?"));
}

TEST(Richardson, TakesTheFinestLevelWhereNothingChangesAnyMore) {
  const Extrapolation found = richardson(level(4, 1), level(1, 1), level(1, 1), kHalved);
  EXPECT_EQ(found.uncertainty, 0);
  EXPECT_EQ(rms_difference(found.forces, level(1, 1)), 0);
}

}  // namespace
}  // namespace forcebound::lab
