#include "forcebound/client/commands/identify/first_guess.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace forcebound::client::commands::identify {
namespace {

constexpr double kBreakAwayShare = 0.8;  // of the force that broke it away, part of which accelerated it

struct Curve {
  double drive = 0;  ///< acceleration without damping
  double squares = std::numeric_limits<double>::infinity();
};

/// The best motion of this rate of damping from this speed: x0 + speed (1 - e^-rt) / rate + drive (t - ...) / rate.
Curve curve_of(const Slide& slide, double speed, double rate) {
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const auto row_at = [&](double s) {
    const double z = rate * s;
    if (z < 1e-3) return Eigen::Vector3d(1, s, s * s / 2);
    const double phi = -std::expm1(-z) / rate;
    return Eigen::Vector3d(1, phi, (s - phi) / rate);
  };
  const double begin_s = slide.samples.front().latched_s;
  for (const SlideSample& sample : slide.samples) {
    const Eigen::Vector3d all = row_at(sample.latched_s - begin_s);
    const Eigen::Vector2d row(all[0], all[2]);
    matrix += row * row.transpose();
    right += row * (sample.progress - speed * all[1]);
  }
  const Eigen::Vector2d part = matrix.inverse() * right;
  const Eigen::Vector3d found(part[0], speed, part[1]);
  Curve curve{.drive = found[2], .squares = 0};
  for (const SlideSample& sample : slide.samples) {
    const double off = sample.progress - row_at(sample.latched_s - begin_s).dot(found);
    curve.squares += off * off;
  }
  return curve;
}

}  // namespace

JointGuess first_guess(const Slide& slide, double speed, double break_away) {
  constexpr std::array kRates{0.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
  constexpr double kAsGood = 1.3;
  std::array<Curve, kRates.size()> curves{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kRates.size(); ++i) {
    curves[i] = curve_of(slide, speed, kRates[i]);
    if (curves[i].drive > 0) least = std::min(least, curves[i].squares);
  }
  const double force = slide.samples.back().force - kBreakAwayShare * break_away;
  for (std::size_t i = 0; i < kRates.size(); ++i) {
    if (!(curves[i].drive > 0) || curves[i].squares > kAsGood * least) continue;
    const double mass = force / curves[i].drive;
    return {.mass = mass, .damping = kRates[i] * mass, .friction = kBreakAwayShare * break_away};
  }
  // It does not even speed up: what a constant acceleration over that way would need.
  const double time_s = slide.samples.back().latched_s - slide.samples.front().latched_s;
  const double way = std::max(slide.samples.back().progress - slide.samples.front().progress, 1e-9);
  return {.mass = force * time_s * time_s / (2 * way), .damping = 0, .friction = kBreakAwayShare * break_away};
}

}  // namespace forcebound::client::commands::identify
