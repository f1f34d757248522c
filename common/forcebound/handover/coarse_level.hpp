#pragma once

#include <memory>
#include <optional>

#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::handover {

/// A mesh of few triangles near to all of another one: it arrives long before that one does.
struct CoarseLevel {
  std::shared_ptr<const scene::TriangleMesh> mesh{};
  double error_m = 0;  ///< no point of either surface is further than this from the other one
};

/// No coarse level has a larger error: whoever begins where it held the device finds the surface within the border that
/// is known there, and no force jumps far.
inline constexpr double kCoarseErrorMost_m = 1e-3;

/// Nothing if the mesh is not closed, small enough to arrive soon itself, or needs too many triangles for that error.
[[nodiscard]] std::optional<CoarseLevel> coarse_level_of(const scene::Bvh& tree);

/// How far two surfaces are from each other, where they are so the most. Never less than that; usually at most 1.5
/// times that, or a share of 2^-8 of their size.
[[nodiscard]] double error_between_m(const scene::Bvh& one, const scene::Bvh& other);

/// Holds a coarse level to its error, by the corners of both surfaces.
/// @param full may lack parts, unless it is `whole`
/// @throws HandoverError
void check_error(const scene::Bvh& coarse, double error_m, const scene::Bvh& full, bool whole);

}  // namespace forcebound::handover
