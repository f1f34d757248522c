#include "forcebound/server/robot/impedance_controller.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/server/robot/inverse_kinematics.hpp"
#include "forcebound/server/robot/robot_description.hpp"
#include "forcebound/server/robot/serial_chain.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/robot/scripted_run.hpp"

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;

class ImpedanceControl : public testing::Test {
 protected:
  /// One tick of the robot's loop.
  void tick(const ToolTarget& target) {
    const device::Reading reading = arm_.read(now_);
    torque_ = controller_.torque(reading, target);
    arm_.apply(now_, torque_);
    ++now_;
  }

  [[nodiscard]] ToolPose pose() const { return arm_.model().pose(arm_.truth().joint); }

  device::Reading reading_at(const Vector& joint) {
    device::Reading reading = arm_.read(now_);
    reading.joint = joint;
    reading.position = joint;
    reading.latched = now_++;
    return reading;
  }

  SimulatedArm arm_{free_task(), 1};
  ImpedanceController controller_{arm_.model()};
  milliseconds now_{0};
  Vector torque_;
};

TEST_F(ImpedanceControl, BringsTheToolToItsTargetWithoutOvershoot) {
  ToolTarget target = held(pose());
  target.pose.position += Eigen::Vector3d(0.05, -0.04, -0.05);
  target.pose.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX())) * target.pose.orientation;
  double beyond_m = 0;
  for (int i = 0; i < 3000; ++i) {
    tick(target);
    beyond_m = std::max(beyond_m, target.pose.position.z() - pose().position.z());
  }
  // What friction of the gears holds against 2000 N/m and 100 N m/rad.
  EXPECT_LT((pose().position - target.pose.position).norm(), 4e-3);
  EXPECT_LT(turn_between(pose().orientation, target.pose.orientation).norm(), 0.025);
  EXPECT_LT(beyond_m, 2.5e-3);
}

TEST_F(ImpedanceControl, IsASpringOfItsStiffnessToWhoeverPushes) {
  const ToolTarget target = held(pose());
  const auto off_at = [&](double force_N) {
    Vector6 push = Vector6::Zero();
    push.x() = force_N;
    arm_.push(now_, push);
    for (int i = 0; i < 1500; ++i) tick(target);
    return pose().position.x() - target.pose.position.x();
  };
  // The difference is free of most of the friction, as both pushes go the same way.
  const double at_20_N = off_at(20);
  const double at_40_N = off_at(40);
  EXPECT_NEAR(20 / (at_40_N - at_20_N), 2000, 200);
}

TEST_F(ImpedanceControl, PostureMovesNothingAtTheTool) {
  // Away from the rest posture by its own null space: the elbow to the side.
  Vector aside = arm_.truth().joint;
  aside[2] += 0.3;
  const device::Reading reading = reading_at(aside);
  const ToolTarget here = held(arm_.model().pose(aside));
  const Vector torque = controller_.torque(reading, here);
  const Matrix mass = arm_.model().mass_matrix(aside);
  const Vector acceleration = mass.llt().solve(torque);
  EXPECT_GT(acceleration.norm(), 0.5) << "it returns to its posture";
  EXPECT_LT((arm_.model().jacobian(aside) * acceleration).norm(), 1e-9);
}

TEST_F(ImpedanceControl, KeepsWithinTorqueLimitsWhereverTheTargetIs) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-3, 3);
  const Vector most = arm_.model().limits().torque_max;
  for (int game = 0; game < 300; ++game) {
    ToolTarget target;
    target.pose.position = {number(random), number(random), number(random)};
    target.pose.orientation =
        Eigen::Quaterniond(number(random), number(random), number(random), number(random)).normalized();
    target.velocity = {number(random), number(random), number(random)};
    Vector q = arm_.model().rest();
    for (double& joint : q) joint += 0.6 * number(random);
    const Vector torque = controller_.torque(reading_at(q), target);
    ASSERT_TRUE(torque.allFinite());
    EXPECT_LE(torque.cwiseQuotient(most).cwiseAbs().maxCoeff(), 1 + 1e-12);
  }
}

TEST_F(ImpedanceControl, StaysCalmAtASingularPosture) {
  // Stretched out: the target is a metre further away than the arm is long.
  ToolTarget target = held(pose());
  target.pose.position = {1.6, 0, 0.5};
  bool singular = false;
  for (int i = 0; i < 6000; ++i) {
    tick(target);
    singular = singular || controller_.report().singular;
    ASSERT_TRUE(torque_.allFinite());
  }
  EXPECT_TRUE(singular);
  EXPECT_LT(arm_.truth().joint_velocity.norm(), 0.05) << "it came to rest there";
  // And back again.
  target = held(arm_.model().pose(arm_.model().rest()));
  for (int i = 0; i < 6000; ++i) tick(target);
  EXPECT_LT((pose().position - target.pose.position).norm(), 5e-3);
}

TEST_F(ImpedanceControl, KeepsItsSpeedLimits) {
  ImpedanceSettings strong;
  strong.stiffness_N_per_m = 5000;
  strong.force_N_max = 400;
  strong.damping_ratio = 0.2;
  controller_.set(strong);
  ToolTarget target = held(pose());
  target.pose.position.y() += 0.5;
  double fastest = 0;
  bool limited = false;
  for (int i = 0; i < 1500; ++i) {
    tick(target);
    fastest = std::max(fastest, arm_.truth().tool.velocity.norm());
    limited = limited || controller_.report().too_fast;
  }
  EXPECT_TRUE(limited) << "it was never asked to be too fast";
  EXPECT_LT(fastest, 1.1 * arm_.model().limits().tool_speed_m_per_s_max);
}

TEST_F(ImpedanceControl, PushesJointsBackFromTheirLimits) {
  const RobotLimits& limits = arm_.model().limits();
  for (Eigen::Index joint = 0; joint < 7; ++joint) {
    SCOPED_TRACE(joint);
    ImpedanceSettings without;
    without.limit_torque_share = 0;
    for (const bool upper : {true, false}) {
      Vector q = arm_.model().rest();
      q[joint] = upper ? limits.highest[joint] - 0.05 : limits.lowest[joint] + 0.05;
      ImpedanceController free(arm_.model(), without);
      ImpedanceController guarded(arm_.model());
      const ToolTarget here = held(arm_.model().pose(q));
      const double push = guarded.torque(reading_at(q), here)[joint] - free.torque(reading_at(q), here)[joint];
      EXPECT_NEAR(push, (upper ? -1 : 1) * 0.5 * limits.torque_max[joint] * (1 - 0.05 / 0.15), 1e-9);
      EXPECT_TRUE(guarded.report().at_limit);
    }
  }
}

TEST_F(ImpedanceControl, StopsFromAnySpeedWithinTorqueLimits) {
  Vector all = 0.3 * arm_.model().limits().torque_max;
  for (; now_ < milliseconds(150); ++now_) {
    (void)arm_.read(now_);
    arm_.apply(now_, all);
  }
  EXPECT_GT(arm_.truth().joint_velocity.norm(), 1);
  const milliseconds begin = now_;
  while (arm_.truth().joint_velocity.norm() > 0.01 && now_ < milliseconds(3000)) {
    const Vector torque = controller_.stopping_torque(arm_.read(now_));
    EXPECT_LE(torque.cwiseQuotient(arm_.model().limits().torque_max).cwiseAbs().maxCoeff(), 1 + 1e-12);
    arm_.apply(now_, torque);
    ++now_;
  }
  EXPECT_LT(now_ - begin, milliseconds(500));
}

TEST_F(ImpedanceControl, AReadingThatCannotBeUsedGivesNoTorque) {
  device::Reading reading = arm_.read(now_);
  ToolTarget target = held(pose());
  target.pose.position.x() += 0.1;
  EXPECT_GT(controller_.torque(reading, target).norm(), 1);
  reading.status = device::Reading::Status::failed;
  EXPECT_TRUE(controller_.torque(reading, target).isZero(0));
  EXPECT_TRUE(controller_.stopping_torque(reading).isZero(0));
  reading.status = device::Reading::Status::ok;
  reading.joint[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(controller_.torque(reading, target).isZero(0));
}

TEST_F(ImpedanceControl, ATargetThatIsNotFiniteGivesNoTorque) {
  ToolTarget target = held(pose());
  target.pose.position.x() = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(controller_.torque(arm_.read(now_), target).isZero(0));
}

TEST_F(ImpedanceControl, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const ToolTarget target = held(pose());
  const test::AllocationGuard guard;
  for (int i = 0; i < 20; ++i) tick(target);
  (void)controller_.stopping_torque(arm_.read(now_));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

/// A column that turns about z, and joints above it about y and x, bent at rest.
SerialChain arm_of(int joints) {
  std::vector<DescribedJoint> told;
  for (int i = 0; i < joints; ++i) {
    const double height_m = 0.3 * i;
    told.push_back({.axis = i == 0   ? Eigen::Vector3d::UnitZ()
                            : i == 3 ? Eigen::Vector3d::UnitX()
                                     : Eigen::Vector3d::UnitY(),
                    .point_m = {0, 0, height_m},
                    .centre_m = {0, 0, height_m + 0.15},
                    .mass_kg = 2,
                    .inertia_kg_m2 = 0.02 * Eigen::Matrix3d::Identity()});
  }
  SerialChain::Description chain;
  chain.name = "few joints";
  chain.links = links_of(told);
  chain.tool = tool_of(told, {0, 0, 0.3 * joints}, Eigen::Vector3d::Zero());
  chain.limits = {.lowest = Vector::Constant(joints, -2.5),
                  .highest = Vector::Constant(joints, 2.5),
                  .speed_max = Vector::Constant(joints, 3),
                  .torque_max = Vector::Constant(joints, 80),
                  .tool_speed_m_per_s_max = 1,
                  .tool_turn_rad_per_s_max = 3};
  chain.rest = Vector::Zero(joints);
  chain.rest.segment<2>(1) = Eigen::Vector2d(0.6, 0.9);
  return SerialChain(std::move(chain));
}

TEST(ImpedanceOfFewJoints, PlacesTheToolAndLeavesItsOrientationFree) {
  for (const int joints : {3, 4, 5}) {
    const SerialChain arm = arm_of(joints);
    const control::Damping damping = control::Damping::from_matrix(Matrix::Identity(joints, joints));
    ImpedanceController controller(arm);
    EXPECT_EQ(controller.settings().stiffness_N_m_per_rad, 0) << "so that nobody is shown a torque of it";
    Vector q = arm.rest();
    Vector speed = Vector::Zero(joints);
    ToolTarget target = held(arm.pose(q));
    target.pose.position += Eigen::Vector3d(-0.02, 0.03, 0.04);
    double beyond_m = 0;
    for (int i = 0; i < 3000; ++i) {
      device::Reading reading;
      reading.joint = reading.position = q;
      reading.jacobian = Matrix::Identity(joints, joints);
      reading.damping = &damping;
      reading.latched = milliseconds(i);
      const Vector torque = controller.torque(reading, target);
      speed += 1e-3 * arm.mass_matrix(q).llt().solve(torque);
      q += 1e-3 * speed;
      beyond_m = std::max(beyond_m, arm.pose(q).position.z() - target.pose.position.z());
    }
    EXPECT_FALSE(controller.report().singular);
    EXPECT_LT((arm.pose(q).position - target.pose.position).norm(), 1e-3) << joints << " joints";
    EXPECT_LT(beyond_m, 2e-3) << joints << " joints";
    EXPECT_LT(speed.norm(), 0.01) << joints << " joints: those that are free come to rest too";
    EXPECT_GT(turn_between(arm.pose(q).orientation, target.pose.orientation).norm(), 0.01) << joints << " joints";
  }
}

TEST(ImpedanceSettings, RefusesWhatMakesNoSense) {
  const SimulatedArm arm(free_task(), 1);
  const auto refused = [&](const ImpedanceSettings& settings) -> std::string {
    try {
      const ImpedanceController controller(arm.model(), settings);
      return "accepted";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refused({.stiffness_N_per_m = -1}), "impedance control: stiffness_N_per_m must be > 0 and finite, got -1");
  EXPECT_EQ(refused({.damping_ratio = std::numeric_limits<double>::infinity()}),
            "impedance control: damping_ratio must be > 0 and finite, got inf");
  EXPECT_EQ(refused({.limit_torque_share = 2}), "impedance control: limit_torque_share must be 0 to 1, got 2");
}

}  // namespace
}  // namespace forcebound::server
