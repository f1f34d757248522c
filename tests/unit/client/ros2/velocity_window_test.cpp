#include "forcebound/client/ros2/velocity_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace forcebound::ros2 {
namespace {

using namespace std::chrono_literals;

StateSample sample_at(Nanoseconds time, double x_m) { return {.time = time, .position = Eigen::Vector3d(x_m, 0, 0)}; }

TEST(VelocityWindow, IsExactInSteadyMotion) {
  VelocityWindow window;
  EXPECT_FALSE(window.update(sample_at(1s, 0)).has_value());
  for (int i = 1; i <= 40; ++i) {
    const auto velocity = window.update(sample_at(1s + i * 1ms, 2e-3 * i));
    ASSERT_TRUE(velocity.has_value());
    EXPECT_NEAR(velocity->linear_m_per_s.x(), 2, 1e-9) << i;
  }
}

TEST(VelocityWindow, TurnsByTheShorterWayAboutTheScenesAxes) {
  VelocityWindow window;
  constexpr double kRate_rad_per_s = 3;
  std::optional<Velocity> velocity;
  for (int i = 0; i <= 10; ++i) {
    StateSample sample = sample_at(1s + i * 1ms, 0);
    const double half = 0.5 * kRate_rad_per_s * 1e-3 * i;
    const double sign = i % 2 == 0 ? 1 : -1;  // q and -q are one orientation
    sample.handle.orientation = {sign * std::cos(half), 0, 0, sign * std::sin(half)};
    velocity = window.update(sample);
  }
  ASSERT_TRUE(velocity.has_value());
  EXPECT_TRUE(velocity->angular_rad_per_s.isApprox(Eigen::Vector3d(0, 0, kRate_rad_per_s), 1e-9));
}

TEST(VelocityWindow, BeginsAnewAfterAReadingThatIsLost) {
  VelocityWindow window;
  (void)window.update(sample_at(1s, 0));
  EXPECT_FALSE(window.update(sample_at(1001ms, std::numeric_limits<double>::quiet_NaN())).has_value());
  EXPECT_FALSE(window.update(sample_at(1002ms, 1)).has_value());
  EXPECT_TRUE(window.update(sample_at(1003ms, 1)).has_value());
}

}  // namespace
}  // namespace forcebound::ros2
