#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Holds the device at a point c: a GuideSpring with
///
///     o = x - c,    w = v
///
/// Parameters: `center_m` c, and those of GuideSpring.
EffectKind spring_to_point_effect();

}  // namespace forcebound::scene
