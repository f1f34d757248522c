#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Ripples of the surface. The server computes no force for them: amplitude and wave vectors go to the client, which
/// renders them at the device's own position and rate (Texture, and answer::ripples_N).
///
/// The ripples follow `direction`, projected onto the surface; where that is along the normal, there are none. A grid
/// has a second wave across. Parameters: `amplitude_N` > 0, `wavelength_m` > 0, `direction`, `pattern` ("ridges" or
/// "grid").
EffectKind texture_effect();

}  // namespace forcebound::scene
