#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A surface that pushes back like a spring and a damper along its normal n:
///
///     f = n max(0, K d + G d^2 - B v.n),    d > 0 the depth, v the velocity of the device's point
///
/// Parameters: `stiffness_N_per_m` K > 0, `stiffening_N_per_m2` G >= 0 (default 0; the local stiffness at depth d is K
/// + 2 G d), `damping_N_s_per_m` B >= 0 (default 0). The sum never pulls: a hand that leaves so fast that damping would
/// exceed the spring feels no force rather than suction.
EffectKind surface_effect();

}  // namespace forcebound::scene
