#include "forcebound/handover/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace forcebound::handover {
namespace {

using Box = Eigen::AlignedBox3d;

/// Boxes that follow one another, as pieces of a geometry that lie beside one another do.
struct Group {
  Box box;  // about all of them
  std::span<const Box> boxes;
};

/// About as many groups as each has boxes.
std::vector<Group> groups_of(std::span<const Box> boxes) {
  const auto most = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(boxes.size()))));
  std::vector<Group> groups;
  groups.reserve(most);
  while (!boxes.empty()) {
    Group group{.box = {}, .boxes = boxes.first(std::min(most, boxes.size()))};
    for (const Box& box : group.boxes) group.box.extend(box);
    groups.push_back(group);
    boxes = boxes.subspan(group.boxes.size());
  }
  return groups;
}

/// Of a cell from the nearest of the boxes, or the most if that is less.
double squared_distance(const Box& cell, const std::vector<Group>& groups, double most) {
  double least = most;
  for (const Group& group : groups) {
    if (cell.squaredExteriorDistance(group.box) >= least) continue;
    for (const Box& box : group.boxes) least = std::min(least, cell.squaredExteriorDistance(box));
  }
  return least;
}

}  // namespace

Coverage Coverage::nothing() {
  // Of no size, since it underestimates nothing.
  const Point somewhere = Point::Zero();
  Coverage none;
  none.box_m_ = Eigen::AlignedBox3d(somewhere, somewhere);
  none.bounds_m_.assign(static_cast<std::size_t>(kCells * kCells * kCells), 0.0F);
  return none;
}

Coverage::Coverage(const Box& box_m, const std::vector<Box>& missing_m) : box_m_(box_m) {
  if (missing_m.empty()) return;
  bounds_m_.reserve(static_cast<std::size_t>(kCells * kCells * kCells));
  const Point cell_m = box_m_.sizes() / static_cast<double>(kCells);
  for (Eigen::Index axis = 0; axis < 3; ++axis) cells_per_m_[axis] = cell_m[axis] > 0 ? 1 / cell_m[axis] : 0;
  const std::vector<Group> groups = groups_of(missing_m);
  for (Eigen::Index k = 0; k < kCells; ++k) {
    for (Eigen::Index j = 0; j < kCells; ++j) {
      double most_m = std::numeric_limits<double>::infinity();
      for (Eigen::Index i = 0; i < kCells; ++i) {
        const Point low_m = box_m_.min() + cell_m.cwiseProduct(Point(static_cast<double>(i), static_cast<double>(j),
                                                                     static_cast<double>(k)));
        const double least_m = std::sqrt(squared_distance(Box(low_m, Point(low_m + cell_m)), groups, most_m * most_m));
        // What is missing is at most one cell farther from the next one.
        most_m = least_m + 1.001 * cell_m.x();
        bounds_m_.push_back(std::nextafterf(static_cast<float>(least_m), 0.0F));
      }
    }
  }
}

double Coverage::known_within_m(const Point& point_m) const noexcept {
  if (whole()) return std::numeric_limits<double>::infinity();
  if (point_m.hasNaN()) return 0;
  // What is missing lies in the box, and nothing in it is nearer to a point outside than to the point's nearest there.
  const Point inside_m = point_m.cwiseMax(box_m_.min()).cwiseMin(box_m_.max());
  const Point at = (inside_m - box_m_.min()).cwiseProduct(cells_per_m_);
  Eigen::Index place = 0;
  for (Eigen::Index axis = 2; axis >= 0; --axis)
    place = place * kCells + std::clamp(static_cast<Eigen::Index>(at[axis]), Eigen::Index{0}, kCells - 1);
  return bounds_m_[static_cast<std::size_t>(place)];
}

}  // namespace forcebound::handover
