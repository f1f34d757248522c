#pragma once

#include "forcebound/control/law_registry.hpp"

/// The other approaches that the paper argues against [Kim 2015, section I], to be compared with on the same device,
/// hand, scene and network. Each is one file beside this one, and one line of `add_rivals`.
namespace forcebound::control {

/// `mbpa`: releasing stays below the remembered path of pressing.
[[nodiscard]] LawDescription memory_based_passivation();

/// `sfa`: a soft spring and an offset that grows while the hand presses.
[[nodiscard]] LawDescription successive_force_augment();

/// `vc`: a passive tool touches the environment, a spring and a damper hold the device to it.
[[nodiscard]] LawDescription virtual_coupling();

void add_rivals(LawRegistry& laws);

}  // namespace forcebound::control
