#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Draws the point to the surface from up to `range_m` above it:
///
///     f = -n F 27/4 s (1 - s)^2,    s = h / range, h the distance above the surface
///
/// The force is greatest, F, at a third of the range, and falls continuously to zero at the surface and at the range. A
/// function of the distance alone, hence conservative. Parameters: `force_N_max` F > 0, `range_m` > 0.
EffectKind magnet_effect();

}  // namespace forcebound::scene
