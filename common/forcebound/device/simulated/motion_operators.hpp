#pragma once

#include "forcebound/device/simulated/operator_settings.hpp"

namespace forcebound::device {

/// From free space along one axis to a depth, and stays there: `press`.
class PressOperator final : public SpecifiedOperator {
 public:
  PressOperator(OperatorSettings settings, int dof);
  [[nodiscard]] Target target(double time_s) const noexcept override;

 private:
  int axis_;
  double from_m_;
  double to_m_;
  double wait_s_;
  double approach_s_;
};

/// Round a circle in the plane of the first two axes, centred on the origin. It first goes from a start radius along
/// the first axis to the radius of the trace, which lies in the wall, and then turns: `trace-circle` (from the middle
/// out into the wall) and `trace-sphere` (from outside in).
class TraceOperator final : public SpecifiedOperator {
 public:
  enum class Wall { around, inside };
  TraceOperator(OperatorSettings settings, int dof, Wall wall);
  [[nodiscard]] Target target(double time_s) const noexcept override;

 private:
  double start_radius_m_;
  double trace_radius_m_;
  double turn_s_;
  double approach_s_;
};

/// Comes down along the third axis onto what lies at the offset, and strokes it there in a figure of eight, `stroke`: a
/// length along the first axis and half of it along the second.
class StrokeOperator final : public SpecifiedOperator {
 public:
  StrokeOperator(OperatorSettings settings, int dof);
  [[nodiscard]] Target target(double time_s) const noexcept override;

 private:
  double height_m_;
  double depth_m_;
  double length_m_;
  double turn_s_;
  double approach_s_;
  Vector offset_m_;
};

/// Picks up what lies at the offset, carries it along the first axis and puts it down, `carry`: comes down along the
/// third axis, presses the button, lifts, carries, lowers, lets the button go, and goes up again.
class CarryOperator final : public SpecifiedOperator {
 public:
  CarryOperator(OperatorSettings settings, int dof);
  [[nodiscard]] Target target(double time_s) const noexcept override;

 private:
  double height_m_;
  double depth_m_;
  double lift_m_;
  double length_m_;
  double approach_s_;  ///< each way down or up
  double wait_s_;      ///< down there; the button changes half way
  double carry_s_;
  Vector offset_m_;
};

/// Free motion, `wave`: on each axis two sines of unrelated frequencies, faded in during the first second.
class WaveOperator final : public SpecifiedOperator {
 public:
  WaveOperator(OperatorSettings settings, int dof);
  [[nodiscard]] Target target(double time_s) const noexcept override;

 private:
  double amplitude_m_;
  double frequency_Hz_;
  Vector offset_m_;
};

}  // namespace forcebound::device
