#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Draws the point to the surface from up to `range_m` above it:
///
///     f = -n F 27/4 s (1 - s)^2,    s = h / range, h the distance above the surface
///
/// F, the most, at a third of the range; nothing at the surface itself and beyond the range, without a step at either.
/// A function of the distance alone, hence conservative. Parameters: `force_N_max` F > 0, `range_m` > 0.
EffectKind magnet_effect();

}  // namespace forcebound::scene
