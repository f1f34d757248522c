#pragma once

#include "forcebound/tissue/corotational_tissue.hpp"

namespace forcebound::test {

/// A tissue under large motion, and a probe that moves on it.
struct FeltTissue {
  explicit FeltTissue(const tissue::CorotationalTissue& model) : tissue(model), body(model.make_body()) {}

  tissue::TissueResult step(const scene::Point& probe_m) { return tissue.step(state, body, probe_m); }

  /// The result of the last of `steps` steps, after one at their start.
  tissue::TissueResult go(const scene::Point& from_m, const scene::Point& to_m, int steps) {
    tissue::TissueResult result;
    for (int n = 0; n <= steps; ++n) result = step(from_m + (to_m - from_m) * n / steps);
    return result;
  }

  [[nodiscard]] scene::Point node_m(int node) const {
    return tissue.mesh().nodes_m()[static_cast<std::size_t>(node)] +
           body.now.displacement_m.segment<3>(3 * static_cast<Eigen::Index>(node));
  }

  const tissue::CorotationalTissue& tissue;
  tissue::TissueState state{};
  tissue::CorotationalBody body;
};

}  // namespace forcebound::test
