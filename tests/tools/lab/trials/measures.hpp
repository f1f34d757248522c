#pragma once

#include <optional>
#include <vector>

#include "forcebound/record/tick_record.hpp"

namespace forcebound::lab {

/// How long a contact rings: the time after first contact until the peak-to-peak of the applied force's magnitude over
/// 20 ms stays below 20 % of its steady mean (that of the last quarter of the contact); the rest of the run if never.
class RingingMeter final : public record::TickSink {
 public:
  /// @param unfelt_N a peak-to-peak that never counts as ringing
  explicit RingingMeter(double unfelt_N = 0) : unfelt_N_(unfelt_N) {}

  void on_tick(const record::TickRecord& tick) noexcept override;

  /// [s]; nothing if there was no contact.
  [[nodiscard]] std::optional<double> ringing_s() const;

  /// From the first contact to the end of the run [s]; 0 if there was none.
  [[nodiscard]] double contact_s() const noexcept { return time_s_.empty() ? 0.0 : time_s_.back() - time_s_.front(); }

 private:
  double unfelt_N_;
  std::vector<double> force_N_;  // since first contact
  std::vector<double> time_s_;
};

/// The largest angle between request and applied force, where both are nonzero.
class DirectionMeter final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override;

  [[nodiscard]] double error_rad_max() const noexcept { return error_rad_max_; }

  /// How many ticks had both forces.
  [[nodiscard]] int samples() const noexcept { return samples_; }

 private:
  double error_rad_max_ = 0;
  int samples_ = 0;
};

/// The displayed rotational stiffness: by how much more torque the handle is turned back for each radian that it turns,
/// over all ticks in contact, by least squares about the means:
///
///     K = - sum (tau - mean tau)'(theta - mean theta) / sum |theta - mean theta|^2
///
/// tau: applied, about the grip; theta: the rotation vector from the scene's axes to the handle's.
class RotationalStiffness final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override;

  /// [N m/rad]; nothing where there is no torque, no contact, or less than a mrad of turning (RMS).
  [[nodiscard]] std::optional<double> stiffness_N_m_per_rad() const;

 private:
  double ticks_ = 0;
  Eigen::Vector3d torque_ = Eigen::Vector3d::Zero();  // sums, as all below
  Eigen::Vector3d turned_ = Eigen::Vector3d::Zero();
  double torque_turned_ = 0;
  double turned_squared_ = 0;
};

}  // namespace forcebound::lab
