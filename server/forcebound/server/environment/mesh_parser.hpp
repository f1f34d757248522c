#pragma once

#include <memory>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/server/environment/checked_table.hpp"
#include "forcebound/server/environment/placement_parser.hpp"

namespace forcebound::server {

inline constexpr scene::NumberParameter kMeshDetail{
    .key = "detail",
    .meaning = "share of the triangles to keep; below 1 of closed meshes only",
    .preset = 1,
    .least = 0,
    .least_excluded = true,
    .most = 1};

inline constexpr scene::NumberParameter kLatheSegments{
    .key = "segments", .meaning = "around the axis", .preset = 128, .least = 3, .most = 4096};

/// Reads a triangle mesh: `file` beside the scene's, placed by `scale`, `rotation_deg` and `offset_m`, with as much
/// `detail` as wanted (default 1: all triangles); felt through a god object, from the front unless `two_sided`.
/// @param reach_m how far outside of it the distance is wanted
/// @throws SceneError
std::unique_ptr<scene::Shape> parse_mesh(CheckedTable& table, double reach_m);

/// The same as a signed distance field of `spacing_m`, at a cost that does not depend on the mesh.
std::unique_ptr<scene::Shape> parse_distance_field(CheckedTable& table, double reach_m);

/// A closed profile turned about the z axis, as a mesh: `profile_m` = [[radius, height], ...], `segments` (default
/// 128), `origin_m`.
std::unique_ptr<scene::Shape> parse_lathe(CheckedTable& table, double reach_m);

}  // namespace forcebound::server
