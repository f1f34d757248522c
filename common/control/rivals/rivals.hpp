#pragma once

#include "forcebound/control/law_registry.hpp"

/// The other approaches that the paper argues against [Kim 2015, section I], to be compared with on the same device,
/// hand, scene and network. Each is one file beside this one, and one line of `add_rivals`.
namespace forcebound::control {

/// `aol`: each axis bounded by its own energy.
[[nodiscard]] LawDescription adjusting_output_limiter();

/// `eba`: the force follows the request with a stiffness between two bounds.
[[nodiscard]] LawDescription energy_bounding();

/// `tdpa`: an observer of the energy given away, and damping when there is too much of it.
[[nodiscard]] LawDescription time_domain_passivity();

void add_rivals(LawRegistry& laws);

}  // namespace forcebound::control
