#pragma once

#include "forcebound/client/commands/identify/release_fit.hpp"

namespace forcebound::client::commands::identify {

/// Mass, damping and friction, roughly, from a joint's first motion under a force somewhat above the one that broke it
/// away: enough to move it to and fro.
/// @param speed at the beginning of the slide
[[nodiscard]] JointGuess first_guess(const Slide& slide, double speed, double break_away);

}  // namespace forcebound::client::commands::identify
