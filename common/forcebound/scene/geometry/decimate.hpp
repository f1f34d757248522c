#pragma once

#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// Reduces a closed mesh to about `share` of its triangles; it stays closed.
///
/// Edges collapse one after the other, each time the one that costs least [Garland and Heckbert 1997]. A vertex x
/// stands for the triangles i that were merged into it, with normals n_i through p_i and weights w_i of a third of
/// their areas, and for the original vertices v_j:
///
///     cost(x) = sum w_i (n_i . (x - p_i))^2 + k sum w_j |x - v_j|^2
///
/// The second sum, with a small k, is ours: it keeps triangles of flat parts in shape and the minimum unique. No edge
/// collapses whose ends have other common neighbours than its two opposite vertices, or where a triangle would turn
/// over or become a needle: so the surface stays the boundary of the same solid, without new holes, handles or folds.
/// Where no edge may collapse any more, the mesh stays finer than asked for.
///
/// Deterministic: ties are broken by the vertices' numbers. A pass over the mesh takes O(n log n) steps.
///
/// @param share in (0, 1]; 1 is the mesh itself
/// @throws GeometryError for another share, or for a mesh that is not closed, or only by slivers that were dropped,
/// unless the share is 1.
[[nodiscard]] TriangleMesh decimated(const TriangleMesh& mesh, double share);

}  // namespace forcebound::scene
