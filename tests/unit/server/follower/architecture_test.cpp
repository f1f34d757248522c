#include "forcebound/server/follower/architecture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "forcebound/control/rotation.hpp"

namespace forcebound::server {
namespace {

TEST(Reflection, TurnsTheHandTowardsTheToolUpToItsLargestTorque) {
  const Eigen::Quaterniond wanted = control::turn_by({0.2, -0.3, 0.1});
  const Eigen::Vector3d lag_rad(0, 0.01, -0.02);
  Reflection tie{.turn_N_m_per_rad = 100, .tool_orientation = control::turn_by(lag_rad) * wanted, .torque_N_m_max = 15};
  EXPECT_LT((tie.torque_at(wanted) - 100 * lag_rad).norm(), 1e-12);
  tie.torque_N_m_max = 0.5;
  EXPECT_NEAR(tie.torque_at(wanted).norm(), 0.5, 1e-12);
  EXPECT_GT(tie.torque_at(wanted).dot(lag_rad), 0);
  EXPECT_TRUE(tie.torque_at(tie.tool_orientation).isZero(1e-12));
  EXPECT_TRUE(Reflection{}.torque_at(wanted).isZero(0)) << "no torque unless an architecture ties orientations";
}

TEST(Reflection, TurnsTheHandWithoutAJumpWhereTheShorterWayChangesItsSide) {
  Reflection tie{.turn_N_m_per_rad = 10, .torque_N_m_max = 5};
  double before_N_m = 0;
  double greatest_change_N_m = 0;
  for (int degrees = 0; degrees <= 360; ++degrees) {
    tie.tool_orientation = control::turn_by({0, 0, static_cast<double>(degrees) * std::numbers::pi / 180});
    const double now_N_m = tie.torque_at(Eigen::Quaterniond::Identity()).z();
    greatest_change_N_m = std::max(greatest_change_N_m, std::abs(now_N_m - before_N_m));
    before_N_m = now_N_m;
    if (degrees > 30 && degrees < 114) {
      EXPECT_NEAR(now_N_m, 5, 1e-12) << "until 2 rad";
    }
  }
  EXPECT_LT(greatest_change_N_m, 0.2);
}

Reflection reflected(std::string_view name, const ImpedanceSettings& impedance, const Vector6& sensed) {
  const auto architecture = find_architecture(name).make(impedance);
  const ToolTarget target;
  const ToolPose tool;
  const Vector6 velocity = Vector6::Zero();
  (void)architecture->ask({.target = target, .tool = tool, .velocity = velocity, .sensed = sensed});
  return architecture->reflection();
}

TEST(PositionForce, ReflectsForceAndTorqueOfTheWristsSensor) {
  Vector6 sensed;
  sensed << 1, 2, -3, 0.1, -0.2, 0.3;
  const Reflection shown = reflected("position-force", {}, sensed);
  const Eigen::Quaterniond wanted = control::turn_by({0.2, -0.3, 0.1});
  EXPECT_TRUE(shown.at(Eigen::Vector3d::Zero()).isApprox(-sensed.head<3>()));
  EXPECT_TRUE(shown.torque_at(wanted).isApprox(-sensed.tail<3>()));
  sensed.tail<3>() *= 1000;
  EXPECT_NEAR(reflected("position-force", {}, sensed).torque_at(wanted).norm(), ImpedanceSettings{}.torque_N_m_max,
              1e-9);
}

TEST(Architectures, ShowNoTorqueOfARobotThatCannotTurnItsTool) {
  for (const ArchitectureKind& kind : architectures()) {
    EXPECT_EQ(reflected(kind.name, {.stiffness_N_m_per_rad = 0}, Vector6::Ones()).torque_N_m_max, 0) << kind.name;
  }
}

}  // namespace
}  // namespace forcebound::server
