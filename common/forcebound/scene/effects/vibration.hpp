#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// An object that vibrates while it is touched:
///
///     f = A w(frequency t + phase) u,    u the surface's normal or a given axis, w between -1 and 1
///
/// Parameters: `amplitude_N`, `frequency_Hz` (up to 500, half of the motions' rate of 1 kHz), `phase_turns`, `along`
/// ("normal" or "axis"), `axis`, `waveform` ("sine", "square", "triangle", "sawtooth").
EffectKind vibration_effect();

}  // namespace forcebound::scene
