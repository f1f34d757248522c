#pragma once

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// Holds a point to a surface sideways: a spring and a damper that slip above a limit of force, in discrete time, one
/// step for each motion.
///
///     e* = P e + d,   f* = K e* + B d/h                     d the step of the point in the tangent plane, in h
///     |f*| <= limit:  sticks,  e = e*,  f = f*
///     else:           slips,   f = limit f*/|f*|,  e = (f + (B/h) P e) / (K + B/h)
///
/// This is the backward Euler step of an elastoplastic bristle in closed form (Kikuuwe, Takesue, Sano, Mochiyama,
/// Fujimoto 2005), for given displacements. P projects onto the present tangent plane, which never lengthens e. On
/// every step the work of the hand covers the change of the stored energy; the rest is dissipated:
///
///     f.d >= K/2 (|e|^2 - |e before|^2),     |f| <= limit
///
/// The limit while sticking may be above the limit while slipping; the drop between them is dissipated too.
///
/// Trivially copyable; all zeros: not touched yet. Real time: noexcept.
struct Bristle {
  struct Law {
    double stiffness_N_per_m = 0;  ///< K > 0
    double damping_N_s_per_m = 0;  ///< B >= 0
  };
  struct Limits {
    double sticking_N = 0;
    double slipping_N = 0;  ///< <= sticking_N
  };
  struct Step {
    Point position_m;
    Point normal;
    double interval_s = 0;  ///< 0: no damping
  };

  double deflection_m[3];
  double position_m[3];
  double touched;
  double slipping;

  /// Force on the surface; on the point its opposite.
  Point move(const Law& law, const Limits& limits, const Step& step) noexcept;
};

}  // namespace forcebound::scene
