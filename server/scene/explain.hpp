#pragma once

#include <string>

#include "forcebound/server/scene/scene.hpp"

namespace forcebound::server {

/// What will be simulated, and what will not, in lines for a person.
std::string explain(const Scene& scene);

/// The same in one line: "ball (sphere): surface stiffness_N_per_m 10000, damping_N_s_per_m 0".
std::string summary(const Scene& scene);

}  // namespace forcebound::server
