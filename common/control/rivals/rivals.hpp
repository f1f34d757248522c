#pragma once

#include "forcebound/control/law_registry.hpp"

/// The other approaches that the paper argues against [Kim 2015, section I], to be compared with on the same device,
/// hand, scene and network. Each is one file beside this one, and one line of `add_rivals`.
namespace forcebound::control {

/// `aol`: each axis bounded by its own energy.
[[nodiscard]] LawDescription adjusting_output_limiter();

/// `eba`: the force follows the request with a stiffness between two bounds.
[[nodiscard]] LawDescription energy_bounding();

/// `mbpa`: releasing stays below the remembered path of pressing.
[[nodiscard]] LawDescription memory_based_passivation();

/// `pspm`: a spring whose other end moves as far as the energy allows.
[[nodiscard]] LawDescription set_position_modulation();

/// `sfa`: a soft spring and an offset that grows while the hand presses.
[[nodiscard]] LawDescription successive_force_augment();

/// `tdpa`: an observer of the energy given away, and damping when there is too much of it.
[[nodiscard]] LawDescription time_domain_passivity();

/// `tdpa-2port`: an observer and a controller of passivity at each end of the network.
[[nodiscard]] LawDescription two_port_passivity();

/// `tla`: the environment's force, paid from a tank of energy at each end of the network.
[[nodiscard]] LawDescription two_layer();

/// `vc`: a passive tool touches the environment, a spring and a damper hold the device to it.
[[nodiscard]] LawDescription virtual_coupling();

/// `wave`: force and velocity travel as waves.
[[nodiscard]] LawDescription wave_variables();

void add_rivals(LawRegistry& laws);

}  // namespace forcebound::control
