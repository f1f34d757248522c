#pragma once

#include "forcebound/control/law_registry.hpp"

/// The other approaches that the paper argues against [Kim 2015, section I], to be compared with on the same device,
/// hand, scene and network. Each is one file beside this one, and one line of `add_rivals`.
namespace forcebound::control {

void add_rivals(LawRegistry& laws);

}  // namespace forcebound::control
