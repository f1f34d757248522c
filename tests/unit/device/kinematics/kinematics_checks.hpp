#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>

#include "forcebound/device/kinematics/kinematics.hpp"

namespace forcebound::test {

using device::Kinematics;
using device::Matrix;
using device::Vector;

inline Vector vector_of(std::initializer_list<double> numbers) {
  Vector result(static_cast<Eigen::Index>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), result.data());
  return result;
}

/// By central differences of the position.
inline Matrix numeric_jacobian(const Kinematics& kinematics, const Vector& joint) {
  constexpr double kStep_rad = 1e-6;
  Matrix result(kinematics.position(joint).size(), joint.size());
  for (Eigen::Index i = 0; i < joint.size(); ++i) {
    Vector above = joint;
    Vector below = joint;
    above[i] += kStep_rad;
    below[i] -= kStep_rad;
    result.col(i) = (kinematics.position(above) - kinematics.position(below)) / (2 * kStep_rad);
  }
  return result;
}

/// Places in a box about the origin, at which the joints lead back to the place and the Jacobian is the derivative.
inline void expect_consistent(const Kinematics& kinematics, const Vector& half_m, int places = 300) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(-1, 1);
  for (int i = 0; i < places; ++i) {
    const Vector wanted = half_m.unaryExpr([&](double half) { return half * share(random); });
    const Vector joint = kinematics.joints_at(wanted);
    ASSERT_LT((kinematics.position(joint) - wanted).norm(), 1e-12) << wanted.transpose();
    const Matrix jacobian = kinematics.jacobian(joint);
    ASSERT_LT((numeric_jacobian(kinematics, joint) - jacobian).norm(), 1e-8 * jacobian.norm()) << wanted.transpose();
  }
}

/// Joints of any size, reached or not, and places in reach or not. @param most of an element of the Jacobian [m/rad]
inline void expect_finite_everywhere(const Kinematics& kinematics, Eigen::Index joints, double most) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> angle(-10, 10);
  const auto expect_finite = [&](const Vector& joint) {
    const Vector position = kinematics.position(joint);
    ASSERT_TRUE(position.allFinite()) << joint.transpose();
    const Matrix jacobian = kinematics.jacobian(joint);
    ASSERT_TRUE(jacobian.allFinite()) << joint.transpose();
    ASSERT_LE(jacobian.cwiseAbs().maxCoeff(), most) << joint.transpose();
  };
  for (int i = 0; i < 20'000; ++i) {
    Vector joint(joints);
    // Every fifth joint at a right angle, where singular places are.
    for (double& q : joint) q = i % 5 == 0 ? std::round(angle(random)) * std::numbers::pi / 2 : angle(random);
    expect_finite(joint);
    if (i % 50 != 0) continue;
    const Eigen::Index axes = kinematics.position(joint).size();
    const Vector place = Vector::NullaryExpr(axes, [&] { return angle(random); });
    expect_finite(kinematics.joints_at(place));
    expect_finite(kinematics.joints_at(1e-3 * place));
    expect_finite(kinematics.joints_at(1e200 * place));
  }
  expect_finite(Vector::Zero(joints));
}

}  // namespace forcebound::test
