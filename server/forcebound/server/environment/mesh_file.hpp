#pragma once

#include <string>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::server {

/// Reads a triangle mesh from an OBJ, STL (text or binary) or OFF file; the ending of its name, in any case, says
/// which. Polygons are cut into triangles; materials, normals and texture coordinates are ignored.
///
/// The file is read by Assimp, which holds coordinates in single precision: about seven digits of the largest one.
///
/// @throws scene::GeometryError, one line that begins with the file and, for text files, the line of the mistake: a
/// coordinate that is not a finite number in single precision, an index out of range, a face of less than three
/// corners, a file that ends too early, no triangles.
[[nodiscard]] scene::TriangleMesh load_mesh(const std::string& path, const scene::MeshPlacement& placement = {});

/// The triangles that a shape with the keys of scene::mesh_parameters asks for; nothing of another shape.
/// @param folder its `file` is relative to it
/// @throws scene::GeometryError
[[nodiscard]] scene::ShapeGeometry triangles_of(const scene::ShapeKind& kind, const config::Values& given,
                                                const std::string& folder);

}  // namespace forcebound::server
