#pragma once

#include <forcebound/scene/effects/effect.hpp>

/// Gives way in one direction and holds in the other, like a ratchet. The law, with s = e.x and its maximum since the
/// session began:
///
///     f = K (max s - s) e
forcebound::scene::EffectKind ratchet_effect();
