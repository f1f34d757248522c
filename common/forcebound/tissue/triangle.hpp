#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::tissue {

/// Weights of a triangle's corners, >= 0 and in sum 1, for the place on it that is nearest to a point. By the regions
/// of corners, edges and inside, in this order (Ericson 2005, 5.1.5).
[[nodiscard]] inline scene::Point nearest_weights(const scene::Point& a, const scene::Point& b, const scene::Point& c,
                                                  const scene::Point& p) noexcept {
  const scene::Point ab = b - a;
  const scene::Point ac = c - a;
  const double b_from_a = ab.dot(p - a);
  const double c_from_a = ac.dot(p - a);
  if (b_from_a <= 0 && c_from_a <= 0) return {1, 0, 0};
  const double b_from_b = ab.dot(p - b);
  const double c_from_b = ac.dot(p - b);
  if (b_from_b >= 0 && c_from_b <= b_from_b) return {0, 1, 0};
  const double on_c = b_from_a * c_from_b - b_from_b * c_from_a;
  if (on_c <= 0 && b_from_a >= 0 && b_from_b <= 0) {
    const double share = b_from_a / (b_from_a - b_from_b);
    return {1 - share, share, 0};
  }
  const double b_from_c = ab.dot(p - c);
  const double c_from_c = ac.dot(p - c);
  if (c_from_c >= 0 && b_from_c <= c_from_c) return {0, 0, 1};
  const double on_b = b_from_c * c_from_a - b_from_a * c_from_c;
  if (on_b <= 0 && c_from_a >= 0 && c_from_c <= 0) {
    const double share = c_from_a / (c_from_a - c_from_c);
    return {1 - share, 0, share};
  }
  const double on_a = b_from_b * c_from_c - b_from_c * c_from_b;
  if (on_a <= 0 && c_from_b >= b_from_b && b_from_c >= c_from_c) {
    const double share = (c_from_b - b_from_b) / ((c_from_b - b_from_b) + (b_from_c - c_from_c));
    return {0, 1 - share, share};
  }
  const double sum = on_a + on_b + on_c;
  return {1 - on_b / sum - on_c / sum, on_b / sum, on_c / sum};
}

}  // namespace forcebound::tissue
