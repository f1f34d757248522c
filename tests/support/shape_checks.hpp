#pragma once

#include <gtest/gtest.h>

#include <array>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::test {

/// A session's state of a shape: none yet, or a direction.
class KeptNormal {
 public:
  KeptNormal() = default;
  explicit KeptNormal(const scene::Point& normal) : numbers_{normal.x(), normal.y(), normal.z()} {}

  [[nodiscard]] std::byte* bytes() { return reinterpret_cast<std::byte*>(numbers_.data()); }

 private:
  std::array<double, 3> numbers_{};
};

inline scene::SurfacePoint nearest(const scene::Shape& shape, const scene::Point& position_m) {
  return shape.nearest(position_m, KeptNormal().bytes());
}

/// After a contact with the normal `last`.
inline scene::SurfacePoint nearest_after(const scene::Shape& shape, const scene::Point& position_m,
                                         const scene::Point& last) {
  return shape.nearest(position_m, KeptNormal(last).bytes());
}

/// @param tolerance of the normal, and of the penetration in metres
inline void expect_surface(const scene::SurfacePoint& found, const scene::Point& normal, double penetration_m,
                           double tolerance = 1e-15) {
  EXPECT_LT((found.normal - normal).norm(), tolerance) << "normal [" << found.normal.transpose() << "]";
  EXPECT_NEAR(found.penetration_m, penetration_m, tolerance);
  EXPECT_FALSE(found.normal_is_old);
}

/// Checks that the penetration is minus a signed distance: it falls by the step along the normal, and changes by no
/// more than the step in any other direction. Not true nearer than the step to a shape's skeleton.
inline void expect_distance_at(const scene::Shape& shape, const scene::Point& position_m, double step_m) {
  const scene::SurfacePoint here = nearest(shape, position_m);
  ASSERT_NEAR(here.normal.norm(), 1, 1e-12) << position_m.transpose();
  const double ahead_m = nearest(shape, position_m + step_m * here.normal).penetration_m;
  EXPECT_NEAR((here.penetration_m - ahead_m) / step_m, 1, 1e-5) << position_m.transpose();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const scene::Point aside = position_m + step_m * scene::Point::Unit(axis);
    EXPECT_LE(std::abs(nearest(shape, aside).penetration_m - here.penetration_m), step_m * (1 + 1e-5))
        << position_m.transpose();
  }
}

}  // namespace forcebound::test
