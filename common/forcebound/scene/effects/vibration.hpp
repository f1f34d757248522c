#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// An object that hums while it is touched:
///
///     f = A w(frequency t + phase) u,    u the surface's normal or a given axis, w between -1 and 1
///
/// Parameters: `amplitude_N`, `frequency_Hz` (up to 500, which motions at 1 kHz can just carry), `phase_turns`, `along`
/// ("normal" or "axis"), `axis`, `waveform` ("sine", "square", "triangle", "sawtooth").
EffectKind vibration_effect();

}  // namespace forcebound::scene
