#include "forcebound/scene/geometry/pseudonormals.hpp"

#include <cmath>

namespace forcebound::scene {

Pseudonormals::Pseudonormals(const TriangleMesh& mesh)
    : mesh_(&mesh), at_vertices_(mesh.vertices_m().size(), Point::Zero()) {
  if (!mesh.report().closed()) {
    throw GeometryError(mesh.name() + ": has no inside, since it is not closed: " + to_text(mesh.report()));
  }
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Point a = mesh.corner_m(i, (corner + 1) % 3) - mesh.corner_m(i, corner);
      const Point b = mesh.corner_m(i, (corner + 2) % 3) - mesh.corner_m(i, corner);
      at_vertices_[mesh.triangles()[i][corner]] += std::atan2(a.cross(b).norm(), a.dot(b)) * mesh.normals()[i];
    }
  }
}

bool Pseudonormals::is_inside(const Point& point_m, const NearestPoint& nearest) const noexcept {
  const auto normal = [&]() -> Point {
    const Point& own = mesh_->normals()[nearest.triangle];
    if (nearest.part.kind == TrianglePart::Kind::corner) {
      return at_vertices_[mesh_->triangles()[nearest.triangle][nearest.part.index]];
    }
    if (nearest.part.kind == TrianglePart::Kind::face) return own;
    const std::uint32_t beyond = mesh_->neighbours()[nearest.triangle][nearest.part.index];
    return beyond == TriangleMesh::kNone ? own : Point(own + mesh_->normals()[beyond]);
  };
  return (point_m - nearest.point_m).dot(normal()) < 0;
}

}  // namespace forcebound::scene
