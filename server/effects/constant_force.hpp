#pragma once

#include "forcebound/server/effects/effect.hpp"

namespace forcebound::server {

/// The same force everywhere and always. Parameter: `force_N`.
EffectKind constant_force_effect();

}  // namespace forcebound::server
