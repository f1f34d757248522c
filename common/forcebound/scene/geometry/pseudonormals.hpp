#pragma once

#include <vector>

#include "forcebound/scene/geometry/bvh.hpp"

namespace forcebound::scene {

/// Tells inside from outside of a closed mesh by the sign of the dot product with the pseudonormal at the nearest point
/// of the surface: the mean of the normals there, weighted by the angles of their triangles [Baerentzen and Aanaes,
/// "Signed Distance Computation Using the Angle Weighted Pseudonormal", IEEE TVCG 2005].
class Pseudonormals {
 public:
  /// @throws GeometryError if the mesh is not closed: it has no inside.
  explicit Pseudonormals(const TriangleMesh& mesh);

  /// Whether the point is behind the surface. `nearest` must come from a Bvh of the same mesh.
  ///
  /// Real time: noexcept, no allocation.
  [[nodiscard]] bool is_inside(const Point& point_m, const NearestPoint& nearest) const noexcept;

  [[nodiscard]] std::size_t memory_bytes() const noexcept { return at_vertices_.size() * sizeof(Point); }

 private:
  const TriangleMesh* mesh_;
  std::vector<Point> at_vertices_;
};

}  // namespace forcebound::scene
