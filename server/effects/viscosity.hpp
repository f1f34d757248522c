#pragma once

#include "forcebound/server/effects/effect.hpp"

namespace forcebound::server {

/// A still medium that resists every motion:
///
///     f = -B v,    v the velocity of the device's point
///
/// Parameter: `damping_N_s_per_m` B >= 0. It takes energy only: f.v <= 0.
EffectKind viscosity_effect();

}  // namespace forcebound::server
