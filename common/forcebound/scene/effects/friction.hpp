#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Dry friction on the surface of an object, under the pressure N of its other effects: it sticks up to
/// static_coefficient times N and slips at dynamic_coefficient times N. The model is that of bristle.hpp, which never
/// returns more energy than it had stored, does not creep, and does not chatter at rest.
///
/// Parameters: `static_coefficient` >= `dynamic_coefficient` >= 0 (default: the same), `stiffness_N_per_m` (default
/// 1000) and `damping_N_s_per_m` (default 0) of the bristle.
EffectKind friction_effect();

}  // namespace forcebound::scene
