#pragma once

#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// A closed mesh with about that share of its triangles, which stays closed.
///
/// Edges collapse one after the other, each time the one that costs least [Garland and Heckbert 1997]. A vertex x
/// stands for the triangles i it has come from, of normals n_i through p_i and a third of whose areas w_i is its own,
/// and for the vertices v_j, at which they were:
///
///     cost(x) = sum w_i (n_i . (x - p_i))^2 + k sum w_j |x - v_j|^2
///
/// The second sum, of a small k, is ours: it keeps triangles of flat parts in shape and the minimum unique. No edge
/// collapses whose ends have other common neighbours than the two that see it, or where a triangle would turn over or
/// become a needle: so the surface stays the boundary of the same solid, without new holes, handles or folds. Where no
/// edge is left that may, the mesh stays finer than asked for.
///
/// Deterministic: equal costs go by the vertices' numbers. A pass over the mesh takes O(n log n) steps.
///
/// @param share in (0, 1]; 1 is the mesh itself
/// @throws GeometryError for another share, or for a mesh that is not closed, or only by slivers that were dropped,
/// unless the share is 1.
[[nodiscard]] TriangleMesh decimated(const TriangleMesh& mesh, double share);

}  // namespace forcebound::scene
