#pragma once

#include <forcebound/server/effects/effect.hpp>

/// Gives way in one direction and holds in the other, like a ratchet. The law, with s = e.x and its most since the
/// session began:
///
///     f = K (max s - s) e
forcebound::server::EffectKind ratchet_effect();
