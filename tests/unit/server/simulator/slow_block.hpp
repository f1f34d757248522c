#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/unit/server/simulator/slow_worlds.hpp"

namespace forcebound::server {

/// A soft block, that of client/python/examples/soft_body.py: 5 x 5 x 4 masses on springs to all their neighbours,
/// standing on a floor, in small displacements. It tells what its top gives way by where a probe is: the stiffness of
/// all of it there, and the mass that moves along with that.
class SlowBlock final : public SlowWorld {
 public:
  SlowBlock() {
    for (int i = 0; i < kAll; ++i) {
      for (int j = 0; j < i; ++j) add_spring(i, j);
    }
    compliance_ = stiffness_.inverse();
  }

  void step(double step_s, const Pushed& pushed) override {
    if (step_s != solved_for_s_) {
      solved_for_s_ = step_s;
      solver_ =
          (kMass_kg * Eigen::MatrixXd::Identity(kFree, kFree) + step_s * (kDamping_s + step_s) * stiffness_).inverse();
    }
    const Eigen::VectorXd pushed_N = share_at(pushed.place_m).transpose() * pushed.force_N;
    const Eigen::VectorXd moved_m = moved_m_ + (step_s + kDamping_s) * speed_m_per_s_;
    speed_m_per_s_ += step_s * solver_ * (pushed_N - stiffness_ * moved_m);
    moved_m_ += step_s * speed_m_per_s_;
  }

  [[nodiscard]] Touch touch(const Point& probe_m) const override {
    const Share share = share_at(probe_m);
    const Eigen::MatrixXd response = compliance_ * share.transpose();
    const Eigen::Matrix3d there_N_per_m = (share * response).inverse();
    const Eigen::MatrixXd shape = response * there_N_per_m;
    const Point moved_m = share * moved_m_;
    return {.place_m = Point(probe_m.x(), probe_m.y(), 0) + moved_m,
            .normal = Point::UnitZ(),
            .velocity_m_per_s = share * speed_m_per_s_,
            .mobility_per_kg = (kMass_kg * shape.transpose() * shape).inverse(),
            .others_N = -there_N_per_m * moved_m,
            .spring_N_per_m = there_N_per_m(2, 2),
            .damper_N_s_per_m = kDamping_s * there_N_per_m(2, 2),
            .friction = 0.4};
  }

 private:
  static constexpr int kWide = 5;
  static constexpr int kHigh = 4;
  static constexpr int kAll = kWide * kWide * kHigh;
  static constexpr int kFree = 3 * kWide * kWide * (kHigh - 1);
  static constexpr double kSpacing_m = 0.015;
  static constexpr double kMass_kg = 0.004;
  static constexpr double kSpring_N_per_m = 100;
  static constexpr double kDamping_s = 0.01;

  using Share = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  static constexpr int node_of(int i, int j, int k) { return i + kWide * (j + kWide * k); }
  static Point cell_of(int node) {
    return Eigen::Vector3i(node % kWide, node / kWide % kWide, node / (kWide * kWide)).cast<double>();
  }
  /// Below zero: it is the floor's.
  static constexpr int row_of(int node) { return node - kWide * kWide; }

  /// How far the top moves there when each node does: of the nine around, by quadratic B-splines.
  static Share share_at(const Point& place_m) {
    std::array<int, 2> first{};
    std::array<std::array<double, 3>, 2> along{};
    for (int axis = 0; axis < 2; ++axis) {
      const double at = std::clamp(place_m[axis] / kSpacing_m + (kWide - 1) / 2.0, 0.0, kWide - 1.0);
      const int middle = std::clamp(static_cast<int>(std::lround(at)), 1, kWide - 2);
      const double u = at - middle;
      first.at(axis) = middle - 1;
      along.at(axis) = {(0.5 - u) * (0.5 - u) / 2, 0.75 - u * u, (0.5 + u) * (0.5 + u) / 2};
    }
    Share share = Share::Zero(3, kFree);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        share.block<3, 3>(0, 3 * row_of(node_of(first[0] + i, first[1] + j, kHigh - 1))) =
            along[0].at(i) * along[1].at(j) * Eigen::Matrix3d::Identity();
      }
    }
    return share;
  }

  void add_spring(int i, int j) {
    const Point cells = cell_of(i) - cell_of(j);
    if (cells.cwiseAbs().maxCoeff() > 1) return;
    const Point along = cells.cwiseProduct(Point(kSpacing_m, kSpacing_m, 0.012)).normalized();
    const Eigen::Matrix3d stiffness = kSpring_N_per_m * along * along.transpose();
    const auto add = [&](int a, int b, double sign) {
      if (row_of(a) >= 0 && row_of(b) >= 0) stiffness_.block<3, 3>(3 * row_of(a), 3 * row_of(b)) += sign * stiffness;
    };
    add(i, i, 1);
    add(j, j, 1);
    add(i, j, -1);
    add(j, i, -1);
  }

  Eigen::MatrixXd stiffness_ = Eigen::MatrixXd::Zero(kFree, kFree);
  Eigen::MatrixXd compliance_;
  double solved_for_s_ = 0;
  Eigen::MatrixXd solver_;
  Eigen::VectorXd moved_m_ = Eigen::VectorXd::Zero(kFree);
  Eigen::VectorXd speed_m_per_s_ = Eigen::VectorXd::Zero(kFree);
};

}  // namespace forcebound::server
