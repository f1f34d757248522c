#pragma once

namespace forcebound::server {

/// The coupling of a probe to its device: a virtual coupling (Colgate, Stanley, Brown 1995) between the device at x_d
/// and the centre of mass x of the body that is the probe, where the force also acts,
///
///     f = K (x_d - x) + B (v_d - v)   on the probe,    -f on the device
///
/// x_d moves on a straight line to the device's newest position with its velocity v_d, over the time between two
/// positions. Each step of length h begins with f at the probe's present position; MuJoCo's `Euler` and `implicit` move
/// the apparent mass m by
///
///     v' = v + h f/m,    x' = x + h v'    with the poles of    z^2 - (2 - b - k) z + (1 - b),    k = h^2 K/m,  b = h
///     B/m
///
/// By Jury's criterion the coupling by itself is stable while k + 2 b < 4. Without a damper (b = 0) it then rings for
/// ever and does not grow. (`implicit` adds the bodies' own damping to m, which only helps.)
struct Coupling {
  double stiffness_N_per_m = 600;
  double damping_N_s_per_m = 4;

  /// (k + 2 b) / 4: below 1 is stable.
  [[nodiscard]] constexpr double share_of_stable(double mass_kg, double step_s) const noexcept {
    return step_s * (step_s * stiffness_N_per_m + 2 * damping_N_s_per_m) / (4 * mass_kg);
  }
};

}  // namespace forcebound::server
