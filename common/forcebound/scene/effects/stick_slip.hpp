#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// The sawtooth force of stick and slip: a spring from an anchor on the surface to the point, until it pulls with
/// `slip_N`; then the anchor jumps to the point.
///
///     f = -K (x - a) in the tangent plane,   a = x where K |x - a| > slip_N
///
/// The energy stored in the spring at the jump is dissipated. Parameters: `stiffness_N_per_m` K > 0, `slip_N` > 0.
EffectKind stick_slip_effect();

}  // namespace forcebound::scene
