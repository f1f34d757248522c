#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Holds the device at a line through c along the unit vector a, free along it: a GuideSpring with
///
///     o = (I - a a')(x - c),    w = (I - a a') v
///
/// Parameters: `through_m` c, `direction` a (any length but zero), and those of GuideSpring.
EffectKind spring_to_line_effect();

}  // namespace forcebound::scene
