#include "forcebound/control/held_force.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/support/ideal_device.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kNaN;
using test::kPeriod_s;
using test::to_matrix;
using test::to_vector;

/// b = [4 2; 2 10], so that f = (4, 5) has f'b^-1 f = 5.
class HeldForceTest : public testing::Test {
 protected:
  HeldForceTest() { begin_at({0, 0}); }

  void begin_at(const std::vector<double>& position_m) {
    Motion motion;
    motion.position = to_vector(position_m);
    motion.damping = &damping_;
    held_.begin(motion);
  }

  Damping damping_ = Damping::from_matrix(to_matrix({{4, 2}, {2, 10}}));
  HeldForce held_{2, kPeriod_s};
};

TEST_F(HeldForceTest, KnowsNothingBeforeTheFirstReading) {
  const HeldForce held(2, kPeriod_s);
  EXPECT_FALSE(held.known());
  EXPECT_FALSE(held.displacement(Motion{}).has_value());
  EXPECT_EQ(held.bounded(to_vector({1, 1}), 1.0), to_vector({0, 0}));
}

TEST_F(HeldForceTest, MeasuresFromWhereTheIntervalBegan) {
  begin_at({1, 2});
  Motion motion;
  motion.position = to_vector({1.5, 1});
  EXPECT_EQ(held_.displacement(motion), to_vector({0.5, -1}));
}

TEST_F(HeldForceTest, ReservesWhatTheWorstMotionReturns) {
  const Vector f = to_vector({4, 5});
  const Matrix b = damping_.matrix();
  const Vector worst = 0.5 * kPeriod_s * b.inverse() * f;
  EXPECT_DOUBLE_EQ(held_.reserve_J(f), 5 * kPeriod_s / 4);
  EXPECT_NEAR(f.dot(worst) - held_.dissipation_J(worst), held_.reserve_J(f), 1e-15);
}

TEST_F(HeldForceTest, ChargesALongerIntervalMoreAndNeverLessThanAPeriod) {
  held_.hold(to_vector({4, 5}));
  const double reserve_J = 5 * kPeriod_s / 4;
  EXPECT_DOUBLE_EQ(held_.worst_case_J(3 * kPeriod_s), 3 * reserve_J);
  for (const double interval_s : {0.0, -1.0, 1e-300, 2e6, 1e308, kInfinity, kNaN}) {
    EXPECT_DOUBLE_EQ(held_.worst_case_J(interval_s), reserve_J);
  }
}

TEST_F(HeldForceTest, BoundsToTheEnergyAndKeepsTheDirection) {
  const Vector request = to_vector({4, 5});
  const Vector f = held_.bounded(request, held_.reserve_J(request) / 9);
  EXPECT_TRUE(f.isApprox(request / 3, 1e-15));
  EXPECT_TRUE(held_.affords(f, held_.reserve_J(request) / 9));
}

TEST_F(HeldForceTest, LeavesAnAffordableRequestAsItIs) {
  const Vector request = to_vector({4, 5});
  EXPECT_EQ(held_.bounded(request, 1.0), request);
  EXPECT_EQ(held_.bounded(to_vector({0, 0}), 1.0), to_vector({0, 0}));
}

TEST_F(HeldForceTest, BoundsToNothingWithoutEnergy) {
  for (const double energy_J : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(held_.bounded(to_vector({4, 5}), energy_J), to_vector({0, 0}));
    EXPECT_FALSE(held_.affords(to_vector({4, 5}), energy_J));
    EXPECT_TRUE(held_.affords(to_vector({0, 0}), energy_J));
  }
}

TEST_F(HeldForceTest, BoundsRequestsThatOverflowWhenSquared) {
  const double most = std::numeric_limits<double>::max();
  for (const double size : {1e160, 1e300, most}) {
    SCOPED_TRACE(size);
    const Vector f = held_.bounded(to_vector({size, size}), 1e-3);
    EXPECT_NEAR(held_.reserve_J(f), 1e-3, 1e-15);
    EXPECT_EQ(f[0], f[1]);
  }
}

TEST_F(HeldForceTest, LeavesRequestsThatUnderflowWhenSquared) {
  for (const double size : {1e-170, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    const Vector request = to_vector({size, -size});
    EXPECT_EQ(held_.bounded(request, 1e-3), request);
  }
}

TEST_F(HeldForceTest, HoldsNothingOnceLost) {
  held_.hold(to_vector({4, 5}));
  held_.lose();
  EXPECT_FALSE(held_.known());
  EXPECT_EQ(held_.force(), to_vector({0, 0}));
  EXPECT_EQ(held_.worst_case_J(1.0), 0.0);
}

TEST(HeldForce, RefusesWhatIsNoTick) {
  EXPECT_THROW(HeldForce(0, kPeriod_s), std::invalid_argument);
  EXPECT_THROW(HeldForce(8, kPeriod_s), std::invalid_argument);
  for (const double period_s : {0.0, -1e-3, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(HeldForce(1, period_s), std::invalid_argument) << period_s;
  }
}

}  // namespace
}  // namespace forcebound::control
