#pragma once

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A flowing fluid that drags the device along:
///
///     f = B u + C |u| u,    u = w - v the fluid's velocity relative to the device
///
/// Parameters: `velocity_m_per_s` w, `damping_N_s_per_m` B >= 0, `drag_N_s2_per_m2` C >= 0 (default 0; for a body in a
/// fast stream C = c_w A rho / 2). In the fluid's frame it only dissipates: f.u >= 0.
EffectKind flow_effect();

}  // namespace forcebound::scene
