#pragma once

#include <memory>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

struct DistanceFieldOptions {
  double spacing_m = 0;               ///< of the grid
  double reach_m = 0;                 ///< how far outside of the mesh's bounding box the distance is known
  std::shared_ptr<const Bvh> tree{};  ///< of the mesh, if there is one
};

/// The solid inside a closed mesh, as its signed distance phi on a grid. The surface point is the nearest one; the cost
/// does not depend on the mesh; sharp edges are rounded by about a grid step.
///
///     phi(x) = sum of c_i(x) c_j(y) c_k(z) phi_ijk over 4 x 4 x 4 nodes      cubic convolution [Keys 1981, a = -1/2]
///     penetration = -phi,   normal = grad phi / |grad phi|
///
/// The gradient is continuous, and planes are exact. Where it vanishes, as in the middle of the solid, the normal is
/// the last valid one. Outside of the grid, penetration is minus the reach, or minus the spacing if that is more.
///
/// Real time: noexcept, no allocation, O(1). Construction finds the mesh's nearest point for every node.
///
/// @throws GeometryError if the mesh is not closed or inside out, if spacing or reach are not finite with spacing_m > 0
/// and reach_m >= 0, or if the grid would have more than 2^22 nodes (32 MB).
std::unique_ptr<Shape> make_distance_field(std::shared_ptr<const TriangleMesh> mesh,
                                           const DistanceFieldOptions& options);

/// A mesh from a file, rendered by its distance field.
ShapeKind distance_field_shape();

}  // namespace forcebound::scene
