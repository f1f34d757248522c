#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// A force sensor with its own rate, white noise and a bias that is drawn at the start. Its samples are taken at whole
/// periods since the start.
///
/// Real time: `pass` is noexcept and allocates nothing.
class ForceSensor {
 public:
  ForceSensor(const ForceSensorFacts& facts, std::uint64_t seed);

  /// The wrench is the one exerted up to `now`, a time since the start.
  void pass(Nanoseconds now, const Vector6& wrench) noexcept;

  /// `sampled` is a time since the start; none: no sample yet.
  [[nodiscard]] const std::optional<SensedForce>& newest() const noexcept { return newest_; }
  [[nodiscard]] const ForceSensorFacts& facts() const noexcept { return facts_; }

 private:
  [[nodiscard]] Eigen::Vector3d noise(double sd) noexcept;

  ForceSensorFacts facts_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Vector6 bias_;
  Nanoseconds next_{0};
  std::optional<SensedForce> newest_;
};

}  // namespace forcebound::server
