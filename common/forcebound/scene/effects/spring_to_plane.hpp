#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Holds the device at a plane through c with the unit normal n, from both sides and free within it: a GuideSpring with
///
///     o = n n'(x - c),    w = n n' v
///
/// Parameters: `through_m` c, `normal` n (any length but zero), and those of GuideSpring.
EffectKind spring_to_plane_effect();

}  // namespace forcebound::scene
