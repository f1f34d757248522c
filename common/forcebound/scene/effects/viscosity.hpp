#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A fluid at rest that resists every motion:
///
///     f = -B v,    v the velocity of the device's point
///
/// Parameter: `damping_N_s_per_m` B >= 0. It only dissipates: f.v <= 0.
EffectKind viscosity_effect();

}  // namespace forcebound::scene
