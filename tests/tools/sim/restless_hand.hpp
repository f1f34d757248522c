#pragma once

#include <string>
#include <vector>

#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::sim {

/// A hand that pulls, holds, shakes and releases by turns, all drawn from a seed; and turns a tip that turns likewise.
class RestlessHand final : public device::Operator {
 public:
  struct Settings {
    std::uint64_t seed = 1;
    int degrees_of_freedom = 1;
    device::Hand hand{};
    double reach_m = 0.02;       ///< how far from the middle it pulls, on each axis
    double duration_s = 10;      ///< afterwards it holds
    double turn_rad = 0;         ///< how far from the scene's axes it turns, about each; 0: it does not
    control::Vector middle_m{};  ///< no rows: the origin
  };

  explicit RestlessHand(const Settings& settings);

  [[nodiscard]] std::string_view name() const noexcept override { return "restless"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return settings_.hand; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return settings_.degrees_of_freedom; }
  [[nodiscard]] Target target(double time_s) const noexcept override;
  [[nodiscard]] Eigen::Vector3d turn(double time_s) const noexcept override;
  [[nodiscard]] std::string description() const override;

 private:
  /// From one position to another in the first half, with a whole number of shakes throughout.
  struct Act {
    double begin_s = 0;
    double length_s = 0;
    control::Vector from;
    control::Vector to;
    control::Vector shake;
    double shakes = 0;
    double grip = 1;
  };

  using Acts = std::vector<Act>;

  [[nodiscard]] static Acts acts_of(std::uint64_t seed, Eigen::Index rows, double reach, double duration_s);
  [[nodiscard]] static Target target_of(const Acts& acts, double time_s) noexcept;

  Settings settings_;
  Acts acts_;
  Acts turns_;
};

}  // namespace forcebound::sim
