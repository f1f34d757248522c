#pragma once

#include <memory>
#include <vector>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

struct MeshShapeOptions {
  bool two_sided = false;  ///< contact from behind as well; else only from where the triangles' normals point
  double reach_m = 0;      ///< without contact, distances to the surface are computed up to this
  std::shared_ptr<const Bvh> tree{};  ///< of the mesh, if there is one: it is copied, which takes less than building
};

/// A triangle mesh with a god object: contact is with the surface that the client's point went through, not with the
/// nearest one.
///
/// Without contact, `penetration_m` is minus the distance to the nearest point of the surface, and `normal` points from
/// there to the client; beyond `reach_m` it is -reach_m. A god object that begins inside a closed mesh is moved to the
/// nearest point of its surface, once; in an open mesh, which has no inside, there is no contact.
///
/// Real time: as GodObject. `reach_m` costs a search for the nearest point on each motion without contact; a first
/// motion deep inside a closed mesh may take milliseconds.
///
/// @throws GeometryError unless reach_m is >= 0 and finite.
std::unique_ptr<Shape> make_mesh(std::shared_ptr<const TriangleMesh> mesh, const MeshShapeOptions& options = {});

/// A mesh from a file, rendered with a god object.
ShapeKind mesh_shape();

/// Keys of a shape that is made of a file's triangles: `file`, where they lie, how much `detail` is kept, and its
/// `own`. Who reads the file gives them as ShapePurpose::geometry.
[[nodiscard]] std::vector<config::Parameter> mesh_parameters(const std::vector<config::Parameter>& own);

/// The triangles given to such a shape. @throws std::invalid_argument if there are none
[[nodiscard]] const std::shared_ptr<const TriangleMesh>& given_mesh(const ShapePurpose& purpose);

}  // namespace forcebound::scene
