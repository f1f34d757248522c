#pragma once

#include <memory>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

struct MeshShapeOptions {
  bool two_sided = false;  ///< contact from behind as well; else only from where the triangles' normals point
  double reach_m = 0;  ///< without contact, the distance to the surface is found up to this; else it is not looked for
};

/// A triangle mesh, felt through a god object: contact is with the surface that the client's point went through, not
/// with the nearest one.
///
/// Without contact, `penetration_m` is minus the distance to the nearest point of the surface, `normal` points from
/// there to the client; beyond `reach_m`, it is -reach_m. A client that a session finds inside of a closed mesh is put
/// to the nearest point of its surface, once; inside of an open one, which has no inside, it is free.
///
/// Real time: as GodObject. `reach_m` costs a search for the nearest point on each motion without contact; one that
/// begins a session deep inside a closed mesh may take milliseconds.
///
/// @throws GeometryError unless reach_m is >= 0 and finite.
std::unique_ptr<Shape> make_mesh(std::shared_ptr<const TriangleMesh> mesh, const MeshShapeOptions& options = {});

}  // namespace forcebound::scene
