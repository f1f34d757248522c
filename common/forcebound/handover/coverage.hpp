#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::handover {

using scene::Point;

/// How far beyond what is touched a surface must be known: the triangles about the god object count too, and a tick's
/// way.
inline constexpr double kBorder_m = 2e-3;

/// Distance to the nearest piece of a geometry that has not arrived yet. Within it the surface is known; the border of
/// what has arrived is no surface.
///
/// A grid of lower bounds, so that the time of a query does not depend on the number of missing pieces.
class Coverage {
 public:
  /// Everything has arrived.
  Coverage() = default;

  /// Nothing has arrived, and where the geometry lies is not known.
  [[nodiscard]] static Coverage nothing();

  /// @param box_m of the whole geometry, in the scene's frame
  /// @param missing_m boxes of the pieces that have not arrived
  Coverage(const Eigen::AlignedBox3d& box_m, const std::vector<Eigen::AlignedBox3d>& missing_m);

  /// Everything nearer to the point than this has arrived [m]; infinite if the whole geometry has, and zero about a
  /// point that is not a number. Real time: O(1).
  [[nodiscard]] double known_within_m(const Point& point_m) const noexcept;

  /// Bound on how much `known_within_m` underestimates the distance.
  [[nodiscard]] double slack_m() const noexcept { return box_m_.isEmpty() ? 0 : box_m_.diagonal().norm() / kCells; }

  [[nodiscard]] bool whole() const noexcept { return bounds_m_.empty(); }

  /// Of the grid; none if everything has arrived.
  [[nodiscard]] std::size_t cells() const noexcept { return bounds_m_.size(); }

 private:
  static constexpr Eigen::Index kCells = 24;  // along each axis

  Eigen::AlignedBox3d box_m_;
  Point cells_per_m_ = Point::Zero();
  std::vector<float> bounds_m_;  // for each cell, rounded down; empty: all is there
};

}  // namespace forcebound::handover
