#pragma once

#include "forcebound/server/effects/effect.hpp"

namespace forcebound::server {

/// Holds the device at a point c: a GuideSpring with
///
///     o = x - c,    w = v
///
/// Parameters: `center_m` c, and those of GuideSpring.
EffectKind spring_to_point_effect();

}  // namespace forcebound::server
