#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// The weight of something in the hand:
///
///     f = m g e
///
/// Parameters: `mass_kg` m >= 0, `direction` e of gravity (any length but zero), `gravity_m_per_s2` g >= 0 (default
/// 9.81). Weight only: inertia would need the hand's acceleration without the network's delay.
EffectKind gravity_effect();

}  // namespace forcebound::scene
