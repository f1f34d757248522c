#pragma once

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// What holds a point to a surface sideways: a spring and a damper that slip under too much force, in the discrete
/// time of the motions.
///
///     e* = P e + d,   f* = K e* + B d/h                     d the step of the point in the tangent plane, in h
///     |f*| <= limit:  sticks,  e = e*,  f = f*
///     else:           slips,   f = limit f*/|f*|,  e = (f + (B/h) P e) / (K + B/h)
///
/// This is the backward Euler step of an elastoplastic bristle in closed form (Kikuuwe, Takesue, Sano, Mochiyama,
/// Fujimoto 2005), for displacements that are given. P projects onto the tangent plane of now, which shortens e at
/// most. On every step the work of the hand pays for what is stored, and the rest is dissipated:
///
///     f.d >= K/2 (|e|^2 - |e before|^2),     |f| <= limit
///
/// The limit while sticking may be above the limit while slipping; the drop between them is dissipated too.
///
/// Trivially copyable; all zeros: has not touched yet. Real time: noexcept.
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
    double interval_s = 0;  ///< 0: the damper has no say
  };

  double deflection_m[3];
  double position_m[3];
  double touched;
  double slipping;

  /// Force on the surface; on the point its opposite.
  Point move(const Law& law, const Limits& limits, const Step& step) noexcept;
};

}  // namespace forcebound::scene
