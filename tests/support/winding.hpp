#pragma once

#include <cmath>
#include <numbers>

#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::test {

/// The solid angle of a mesh, seen from p in its own frame, in full spheres [Van Oosterom and Strackee 1983]: 1 inside
/// of a closed mesh, 0 outside. Sums over all triangles and uses no normals.
inline double winding(const scene::TriangleMesh& mesh, const scene::Point& p) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
    const scene::Point a = mesh.corner_m(t, 0) - p;
    const scene::Point b = mesh.corner_m(t, 1) - p;
    const scene::Point c = mesh.corner_m(t, 2) - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace forcebound::test
