#pragma once

#include "forcebound/scene/geometry/mesh_placement.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// What a file's numbers are multiplied with.
inline constexpr scene::NumberParameter kMeshScale{.key = "scale",
                                                   .meaning = "metres per unit of the file",
                                                   .preset = 1,
                                                   .least = 0,
                                                   .least_excluded = true,
                                                   .most = 1e9};

inline constexpr std::string_view kRotationKey = "rotation_deg";
inline constexpr std::string_view kOffsetKey = "offset_m";

/// Reads `rotation_deg` = [roll, pitch, yaw]; none where the key is absent. @throws SceneError
[[nodiscard]] Eigen::Matrix3d parse_rotation(CheckedTable& table);

/// Reads where what a file holds lies in the scene, by the same keys for meshes and tissue: `scale`, then
/// `rotation_deg`, then `offset_m`, each of which may be absent. @throws SceneError
[[nodiscard]] scene::MeshPlacement parse_placement(CheckedTable& table);

}  // namespace forcebound::server
