#include "forcebound/server/robot/velocity_filter.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;

Vector at(double position) { return Vector::Constant(1, position); }

TEST(VelocityFilter, ComesToAConstantVelocityWithItsTimeConstant) {
  VelocityFilter filter(500);
  EXPECT_EQ(filter.update(milliseconds(0), at(0))[0], 0);
  for (int i = 1; i <= 2; ++i) (void)filter.update(milliseconds(i), at(2e-3 * i));
  EXPECT_NEAR(filter.update(milliseconds(3), at(6e-3))[0], 2 * (1 - std::exp(-1.5)), 1e-12);
  for (int i = 4; i <= 50; ++i) (void)filter.update(milliseconds(i), at(2e-3 * i));
  EXPECT_NEAR(filter.update(milliseconds(51), at(0.102))[0], 2, 1e-9);
}

TEST(VelocityFilter, IgnoresAReadingThatIsNotLater) {
  VelocityFilter filter(500);
  (void)filter.update(milliseconds(0), at(0));
  const double before = filter.update(milliseconds(1), at(1e-3))[0];
  EXPECT_EQ(filter.update(milliseconds(1), at(5))[0], before);
}

TEST(VelocityFilter, BeginsAgainAtZero) {
  VelocityFilter filter(500);
  (void)filter.update(milliseconds(0), at(0));
  (void)filter.update(milliseconds(1), at(1));
  filter.restart();
  EXPECT_EQ(filter.update(milliseconds(2), at(7))[0], 0);
}

}  // namespace
}  // namespace forcebound::server
