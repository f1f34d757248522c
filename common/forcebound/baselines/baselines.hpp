#pragma once

#include "forcebound/control/law_registry.hpp"

/// The approaches that the paper discusses [Kim 2015, section I], for comparison on the same device, hand, scene and
/// network. Each is one file beside this one, and one line of `add_baselines`.
namespace forcebound::baselines {

using control::Matrix;
using control::Vector;

/// `aol`: each axis is bounded by its own energy.
[[nodiscard]] control::LawDescription adjusting_output_limiter();

/// `eba`: the force follows the request with a stiffness between two bounds.
[[nodiscard]] control::LawDescription energy_bounding();

/// `mbpa`: releasing stays below the remembered path of pressing.
[[nodiscard]] control::LawDescription memory_based_passivation();

/// `pspm`: a spring whose other end moves as far as the energy allows.
[[nodiscard]] control::LawDescription set_position_modulation();

/// `sfa`: a soft spring and an offset that grows while the hand presses.
[[nodiscard]] control::LawDescription successive_force_augment();

/// `tdpa`: an observer of the energy returned, and damping when it exceeds the energy taken in.
[[nodiscard]] control::LawDescription time_domain_passivity();

/// `tdpa-2port`: an observer and a controller of passivity at each end of the network.
[[nodiscard]] control::LawDescription two_port_passivity();

/// `tla`: the environment's force, paid from a tank of energy at each end of the network.
[[nodiscard]] control::LawDescription two_layer();

/// `vc`: a passive tool touches the environment, a spring and a damper hold the device to it.
[[nodiscard]] control::LawDescription virtual_coupling();

/// `wave`: force and velocity travel as waves.
[[nodiscard]] control::LawDescription wave_variables();

void add_baselines(control::LawRegistry& laws);

/// The force bounding laws and the baselines: all that ship.
[[nodiscard]] control::LawRegistry shipped_laws();

}  // namespace forcebound::baselines
