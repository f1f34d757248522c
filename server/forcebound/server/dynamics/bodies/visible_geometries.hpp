#pragma once

#include <optional>
#include <vector>

#include "forcebound/scene/visible_part.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// The geometries that MuJoCo's own viewer shows unasked, of kinds that a page draws: no ellipsoids and height fields.
/// @param without geometries of these bodies are left out
[[nodiscard]] std::vector<int> visible_geometries(const mjModel_& model, const std::vector<int>& without, bool planes);

/// In its own frame, without a name; nothing: of a kind that no page draws.
[[nodiscard]] std::optional<scene::VisiblePart> shape_of(const mjModel_& model, int geometry);

/// As it is now.
[[nodiscard]] scene::VisiblePart part_of(const mjModel_& model, const mjData_& data, int geometry);

/// Position and quaternion w, x, y, z of a geometry. Real time. @param to of kNumbersOfSolid
void put_place(const mjData_& data, int geometry, float* to) noexcept;

}  // namespace forcebound::server
