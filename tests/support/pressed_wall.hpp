#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "tests/support/law_loop.hpp"

namespace forcebound::test {

/// A mass with the damping of the paper's device, and a hand that pulls it into a wall at x >= 0.
struct PressedWall {
  double stiffness_N_per_m = 1e4;
  double damping_N_s_per_m = 30;
  double mass_kg = 0.1;
  double hand_N_per_m = 2000;
  double hand_damping_N_s_per_m = 2;
  double from_m = -2e-3;
  double to_m = 10e-3;  ///< reached in half a second
  double duration_s = 3;
  double encoder_step_m = 0;
};

/// What became of it.
struct Pressed {
  double shown_N_per_m = 0;  ///< mean force over mean depth in the last half second
  double swing_m = 0;        ///< how far the device moved in it
  double least_J = 0;        ///< the minimum of P(t), also between ticks
};

/// Plays the hand, the device and the wall in steps of a microsecond.
inline Pressed press_a_wall(std::string_view law, const PressedWall& wall, const LawLoopSetting& setting = {}) {
  constexpr int kStepsPerTick = 1000;
  constexpr double kSettled_s = 0.5;
  LawLoop loop(law, control::Matrix::Constant(1, 1, wall.damping_N_s_per_m), setting);
  const double step_s = setting.period_s / kStepsPerTick;
  const int ticks = static_cast<int>(wall.duration_s / setting.period_s);
  double x_m = wall.from_m;
  double v = 0;
  double audit_J = 0;
  double force_sum_N = 0;
  double depth_sum_m = 0;
  double low_m = wall.to_m;
  double high_m = wall.from_m;
  Pressed result;
  for (int tick = 0; tick < ticks; ++tick) {
    const double now_s = tick * setting.period_s;
    const double q = wall.encoder_step_m;
    const double read_m = q > 0 ? std::round(x_m / q) * q : x_m;
    const double force_N = loop.tick(read_m, -wall.stiffness_N_per_m * std::max(read_m, 0.0));
    const double target_m = wall.from_m + (wall.to_m - wall.from_m) * std::min(1.0, 2 * now_s);
    for (int i = 0; i < kStepsPerTick; ++i) {
      const double hand_N = wall.hand_N_per_m * (target_m - x_m) - wall.hand_damping_N_s_per_m * v;
      v += step_s / wall.mass_kg * (hand_N + force_N - wall.damping_N_s_per_m * v);
      x_m += step_s * v;
      audit_J += step_s * (wall.damping_N_s_per_m * v * v - force_N * v);
      result.least_J = std::min(result.least_J, audit_J);
    }
    if (now_s < wall.duration_s - kSettled_s) continue;
    force_sum_N -= force_N;
    depth_sum_m += read_m;
    low_m = std::min(low_m, x_m);
    high_m = std::max(high_m, x_m);
  }
  result.shown_N_per_m = force_sum_N / depth_sum_m;
  result.swing_m = high_m - low_m;
  return result;
}

}  // namespace forcebound::test
