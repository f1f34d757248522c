#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A sticky surface. Once touched it holds the point: along the normal like a spring that tears at `tear_N`, sideways
/// like a bristle (bristle.hpp) that slips at `shear_N`. What has torn holds again only when touched again.
///
///     f = -n K h - f_t,    h > 0 the distance above the surface, until K h > tear_N
///
/// Tearing dissipates the hand's work tear_N^2/(2 K); a hand that returns before tearing gets its work back.
///
/// Parameters: `stiffness_N_per_m` K > 0, `tear_N` > 0, `shear_stiffness_N_per_m` (default K), `shear_N` >= 0 (default
/// 0).
EffectKind adhesion_effect();

}  // namespace forcebound::scene
