#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// Moves the device by a force that depends on time alone, from the session's first motion on:
///
///     f = A e s(c),    c = f0 (t - t0) + phase/(2 pi) cycles,    t0 <= t < t0 + D;    before and after nothing
///
/// with s of c's fraction p:
///
///     sine      sin(2 pi p)
///     square    1 while p < duty, then -1
///     triangle  from 0 up to 1 at p = 1/4, down to -1 at 3/4 and back
///     sawtooth  from 0 up to 1 at p = 1/2, where it falls to -1, and back up
///     pulse     1 while p < duty, then 0
///     chirp     sin(2 pi p) with c = f0 (t - t0) + (f1 - f0)(t - t0)^2/(2 D) + phase/(2 pi)
///
/// It is computed once for each motion that arrives, so frequencies above half the motions' rate alias; faster ripples
/// are what `texture` is for.
///
/// Parameters: `waveform`, `direction` e (any length but zero), `amplitude_N` A >= 0, `frequency_Hz` f0 > 0,
/// `phase_rad` (default 0), `start_s` t0 >= 0 (default 0), `duration_s` D > 0 (default: for ever); of square and pulse
/// only `duty`, 0 < duty <= 1 (default 0.5); of chirp, which needs a duration, `frequency_end_Hz` f1 > 0.
EffectKind drive_effect();

}  // namespace forcebound::scene
