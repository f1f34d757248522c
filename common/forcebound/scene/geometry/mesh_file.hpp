#pragma once

#include <memory>
#include <string>
#include <vector>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// Reads a triangle mesh from an OBJ, STL (text or binary) or OFF file; the ending of its name, in any case, says
/// which. Polygons are cut into triangles; materials, normals and texture coordinates are ignored.
///
/// The file is read by Assimp, which holds coordinates in single precision: about seven digits of the largest one.
///
/// @throws GeometryError, one line that begins with the file and, for text files, the line of the mistake: a coordinate
/// that is not a finite number in single precision, an index out of range, a face of less than three corners, a file
/// that ends too early, no triangles.
[[nodiscard]] TriangleMesh load_mesh(const std::string& path, const MeshPlacement& placement = {});

/// Keys of a shape that is made of such a file: `file`, where it lies, how much `detail` is kept, and its `own`.
[[nodiscard]] std::vector<config::Parameter> mesh_parameters(const std::vector<config::Parameter>& own);

/// The mesh that their values ask for, unless it is given. @throws GeometryError
[[nodiscard]] std::shared_ptr<const TriangleMesh> mesh_of(const config::Values& values, const ShapePurpose& purpose);

}  // namespace forcebound::scene
