#pragma once

#include "forcebound/server/effects/effect.hpp"

namespace forcebound::server {

/// A surface that pushes back like a spring and a damper along its normal n:
///
///     f = n max(0, K d - B v.n),    d > 0 the depth, v the velocity of the device's point
///
/// Parameters: `stiffness_N_per_m` K > 0, `damping_N_s_per_m` B >= 0 (default 0). The sum never pulls: a hand that
/// leaves faster than the spring would follow feels nothing rather than suction.
EffectKind surface_effect();

}  // namespace forcebound::server
