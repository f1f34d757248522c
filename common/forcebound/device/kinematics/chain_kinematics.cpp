#include "forcebound/device/kinematics/chain_kinematics.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/control/rotation.hpp"

namespace forcebound::device {
namespace {

/// Where the joints that were passed put what follows them.
Eigen::Isometry3d turn(const ChainGeometry::Joint& joint, double angle_rad) noexcept {
  return Eigen::Translation3d(joint.point_m) * Eigen::AngleAxisd(angle_rad, joint.axis) *
         Eigen::Translation3d(-joint.point_m);
}

ChainGeometry checked(ChainGeometry geometry) {
  const auto joints = static_cast<int>(geometry.joints.size());
  const bool axes_known = (geometry.tip_axes >= 1 && geometry.tip_axes <= kTranslations) || geometry.turns();
  if (joints < 1 || joints > control::kDofMax || !axes_known || geometry.tip_axes > joints) {
    throw std::invalid_argument("a chain has 1 to " + std::to_string(control::kDofMax) +
                                " joints and a tip with 1 to 3 or with 6 axes, no more than joints: got " +
                                std::to_string(joints) + " and " + std::to_string(geometry.tip_axes));
  }
  for (ChainGeometry::Joint& joint : geometry.joints) {
    const double length = joint.axis.stableNorm();
    if (!(length > 0) || !joint.axis.allFinite()) throw std::invalid_argument("the axis of a joint has no direction");
    joint.axis /= length;
  }
  return geometry;
}

}  // namespace

ChainKinematics::ChainKinematics(ChainGeometry geometry)
    : geometry_(checked(std::move(geometry))), translations_(std::min(geometry_.tip_axes, kTranslations)) {}

/// What the joints make of the place that anything behind them has while all angles are 0.
Eigen::Isometry3d ChainKinematics::moved(const Vector& joint) const noexcept {
  Eigen::Isometry3d passed = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < geometry_.joints.size(); ++i) {
    passed = passed * turn(geometry_.joints[i], joint[static_cast<Eigen::Index>(i)]);
  }
  return passed;
}

Vector ChainKinematics::position(const Vector& joint) const noexcept {
  return (moved(joint) * geometry_.tip_m).head(translations_);
}

std::optional<Eigen::Quaterniond> ChainKinematics::orientation(const Vector& joint) const noexcept {
  if (!geometry_.turns()) return std::nullopt;
  return Eigen::Quaterniond(moved(joint).linear()).normalized();
}

Matrix ChainKinematics::jacobian(const Vector& joint) const noexcept {
  const auto joints = static_cast<Eigen::Index>(geometry_.joints.size());
  Matrix jacobian(geometry_.tip_axes, joints);
  // From the tip to the base: the tip as the joints from i on move it, in the frame of those before.
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, control::kDofMax> axes(3, joints);
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, control::kDofMax> points(3, joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const ChainGeometry::Joint& at = geometry_.joints[static_cast<std::size_t>(i)];
    axes.col(i) = before.linear() * at.axis;
    points.col(i) = before * at.point_m;
    before = before * turn(at, joint[i]);
  }
  const Eigen::Vector3d tip = before * geometry_.tip_m;
  for (Eigen::Index i = 0; i < joints; ++i) {
    const Eigen::Vector3d axis = axes.col(i);
    const Eigen::Vector3d arm = tip - points.col(i);
    jacobian.col(i).head(translations_) = axis.cross(arm).head(translations_);
    if (geometry_.turns()) jacobian.col(i).tail<kTranslations>() = axis;
  }
  return jacobian;
}

Vector ChainKinematics::start() const noexcept {
  Vector joint(static_cast<Eigen::Index>(geometry_.joints.size()));
  for (Eigen::Index i = 0; i < joint.size(); ++i) joint[i] = geometry_.joints[static_cast<std::size_t>(i)].start_rad;
  return joint;
}

Vector ChainKinematics::missing(const Vector& position, const Eigen::Quaterniond& orientation,
                                const Vector& joint) const noexcept {
  Vector missing(geometry_.tip_axes);
  missing.head(translations_) = position - this->position(joint);
  if (const auto here = this->orientation(joint))
    missing.tail<kTranslations>() = control::rotation_vector(*here, orientation);
  return missing;
}

Vector ChainKinematics::joints_at(const Vector& position) const noexcept {
  return joints_at_pose(position, orientation(start()).value_or(Eigen::Quaterniond::Identity()));
}

Vector ChainKinematics::joints_at_pose(const Vector& position, const Eigen::Quaterniond& orientation) const noexcept {
  Vector joint = start();
  Vector missing = this->missing(position, orientation, joint);
  constexpr int kSteps = 200;
  constexpr double kNear = 1e-13;          // [m], [rad]
  constexpr double kDampingLeast = 1e-12;  // [m^2/rad^2]: singular places stay solvable
  double caution = 1;
  for (int step = 0; step < kSteps && missing.norm() > kNear; ++step) {
    const Matrix jacobian = this->jacobian(joint);
    Matrix damped = jacobian * jacobian.transpose();
    damped.diagonal().array() += caution * missing.squaredNorm() + kDampingLeast;
    const Vector next = joint + jacobian.transpose() * damped.llt().solve(missing);
    const Vector still_missing = this->missing(position, orientation, next);
    // Damping of the size of what is missing converges as fast as Newton's method; more of it where that overshoots.
    if (!(still_missing.squaredNorm() < missing.squaredNorm())) {
      caution *= 10;
      continue;
    }
    joint = next;
    missing = still_missing;
    caution = 1;
  }
  return joint;
}

}  // namespace forcebound::device
