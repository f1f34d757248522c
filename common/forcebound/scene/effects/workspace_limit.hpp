#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A region that holds the device: a ball, a block along the axes, or the intersection of both. Of each of the two,
/// with d > 0 the distance outside of it and n the direction from its nearest point:
///
///     f = -n max(0, K d + B v.n)
///
/// The force never pushes outwards: a hand that returns so fast that damping would exceed the spring feels none.
///
/// Parameters: `center_m`, `radius_m` > 0 and `size_m` >= 0 on every axis, at least one of them; `stiffness_N_per_m`
/// K > 0, `damping_N_s_per_m` B >= 0 (default 0).
EffectKind workspace_limit_effect();

}  // namespace forcebound::scene
