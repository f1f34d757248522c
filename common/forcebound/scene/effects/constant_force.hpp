#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// The same force everywhere and always. Parameter: `force_N`.
EffectKind constant_force_effect();

}  // namespace forcebound::scene
