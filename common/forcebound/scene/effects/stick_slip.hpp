#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// The sawtooth of a surface that lets go in jerks: a spring from an anchor on the surface to the point, until it pulls
/// with `slip_N`; then the anchor jumps to the point.
///
///     f = -K (x - a) in the tangent plane,   a = x where K |x - a| > slip_N
///
/// What the spring had stored at the jump is gone, never returned. Parameters: `stiffness_N_per_m` K > 0, `slip_N` > 0.
EffectKind stick_slip_effect();

}  // namespace forcebound::scene
