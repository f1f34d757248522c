#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "forcebound/device/simulated/operator_settings.hpp"

namespace forcebound::device {

/// A recorded motion: positions, and times since its first row.
struct MotionSample {
  double time_s = 0;
  Vector position;
};

/// Reads `time_s,x_m[,y_m[,z_m]]`, in this order under a header line; the first `dof` positions are used, further
/// columns are ignored.
/// @param place the file's name, for errors.
/// @throws std::runtime_error `PLACE:LINE: ...` unless the header is as above with enough columns, there are at
/// least two rows, all numbers used are finite and time increases from row to row.
[[nodiscard]] std::vector<MotionSample> parse_motion(std::string_view csv_text, const std::string& place, int dof);

/// A recorded hand: `replay:FILE.csv[,KEY=VALUE...]`.
///
/// Between the rows the target is the cubic through their positions with the velocities of the parabola through each
/// row and its neighbours, zero at both ends: continuously differentiable. A session longer than the recording plays it
/// backwards, forwards again, and so on. The description ends with what makes its units doubtful.
class ReplayOperator final : public SpecifiedOperator {
 public:
  /// @param motion from parse_motion.
  /// @throws std::invalid_argument for a setting.
  ReplayOperator(OperatorSettings settings, int dof, std::vector<MotionSample> motion);
  [[nodiscard]] Target target(double time_s) const noexcept override;

  /// See RecordedPace::doubt_of_units; empty: nothing.
  [[nodiscard]] const std::string& doubt() const noexcept { return doubt_; }

 private:
  std::vector<MotionSample> motion_;
  std::vector<Vector> velocity_;
  std::string doubt_;
};

}  // namespace forcebound::device
