#pragma once

#include <string>

#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// Reads a triangle mesh from an OBJ, STL (text or binary) or OFF file; the ending of its name, in any case, says
/// which. Polygons are cut into triangles; materials, normals and texture coordinates are not looked at.
///
/// The file is read by Assimp, which holds coordinates in single precision: about seven digits of the largest one.
///
/// @throws GeometryError, one line that begins with the file and, where it is text, the line of the mistake: whatever
/// is not a finite number in single precision, an index that no vertex has, a face of less than three corners, a file
/// that ends too early, no triangles.
[[nodiscard]] TriangleMesh load_mesh(const std::string& path, const MeshPlacement& placement = {});

}  // namespace forcebound::scene
