#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/tools/lab/accuracy/along.hpp"

namespace forcebound::lab {

/// A table and three slabs on each other, the heaviest on top: hard for a solver. The table is the first body, so that
/// a hand meets what stands on its middle.
inline std::string stack_text(const std::string& bodies = {}) {
  const auto slab = [](const std::string& name, const std::string& z_m, const std::string& mass_kg) {
    return "[[body]]\nname = '" + name + "'\nmass_kg = " + mass_kg + "\nshape = { kind = 'box', center_m = [0, 0, " +
           z_m + "], size_m = [0.04, 0.03, 0.02] }\n";
  };
  return "[scene]\nname = 'stack'\ndescription = ''\ndegrees_of_freedom = 3\n[bodies]\ncontact_time_s = 0.008\n" +
         bodies +
         "\n[[body]]\nname = 'table'\nfixed = true\n"
         "shape = { kind = 'box', center_m = [0, 0, -0.01], size_m = [0.4, 0.4, 0.02] }\n" +
         slab("low", "0.01", "0.05") + slab("middle", "0.03", "0.1") + slab("high", "0.05", "0.2");
}

inline std::shared_ptr<const scene::Scene> stack(const std::string& bodies = {}) {
  return server::parse_scene(stack_text(bodies), "stack.toml");
}

/// A device that comes down on the stack and presses 3 mm into it, beside its middle, one position a millisecond.
inline std::vector<Vector> pressing(int ticks) {
  std::vector<Vector> positions_m;
  positions_m.reserve(static_cast<std::size_t>(ticks));
  for (int i = 0; i < ticks; ++i) {
    positions_m.emplace_back(Eigen::Vector3d(0.004, 0.002, 0.067 - 1e-4 * std::min(i, 100)));
  }
  return positions_m;
}

}  // namespace forcebound::lab
