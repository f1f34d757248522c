#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Pulls toward a point, never harder than F. With r the distance from it and e the direction away from it:
///
///     linear:          f = -e F min(r/R, 1)
///     inverse_square:  f = -e F (3 sqrt(3)/2) (r/R) / (1 + (r/R)^2)^(3/2)
///
/// The second is Plummer's softened law: far away it falls with 1/r^2, at r = R/sqrt(2) it is F. Both depend on r alone
/// and are therefore conservative. At r = 0 there is no direction and no force.
///
/// Parameters: `center_m`, `force_N_max` F >= 0, `radius_m` R > 0 within which it softens, `falloff` (linear or
/// inverse_square).
EffectKind attractor_effect();

}  // namespace forcebound::scene
