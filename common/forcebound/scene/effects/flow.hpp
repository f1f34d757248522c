#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A medium that streams, and drags the device along:
///
///     f = B u + C |u| u,    u = w - v the velocity of the medium as the device sees it
///
/// Parameters: `velocity_m_per_s` w, `damping_N_s_per_m` B >= 0, `drag_N_s2_per_m2` C >= 0 (default 0; of a body in a
/// fast stream C = c_w A rho / 2). It takes energy from the device as seen by the medium: f.u >= 0.
EffectKind flow_effect();

}  // namespace forcebound::scene
