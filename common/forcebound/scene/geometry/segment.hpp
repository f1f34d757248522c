#pragma once

#include <algorithm>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// The segment between two points.
class LineSegment {
 public:
  /// If both points are equal, the axis is x.
  LineSegment(const Point& from_m, const Point& to_m)
      : middle_m_(0.5 * (from_m + to_m)), half_m_(0.5 * (to_m - from_m).stableNorm()) {
    if (half_m_ > 0) axis_ = (to_m - from_m).stableNormalized();
  }

  [[nodiscard]] const Point& middle_m() const noexcept { return middle_m_; }
  [[nodiscard]] const Point& axis() const noexcept { return axis_; }
  [[nodiscard]] double half_m() const noexcept { return half_m_; }

 private:
  Point middle_m_;
  Point axis_ = Point::UnitX();
  double half_m_;
};

}  // namespace forcebound::scene
