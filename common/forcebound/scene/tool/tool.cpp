#include "forcebound/scene/tool/tool.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/geometry/last_normal.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

/// Of a leaf: asking about a ball costs as much as asking about a point.
constexpr std::size_t kLeaf = 4;

/// Of a tool that is as good as a point: turning it costs nothing.
constexpr double kSpreadLeast_m = 1e-3;

constexpr double kRounding_m = 1e-9;

double tip_to_end_m(const ToolPart& part) { return std::max(part.from_m.norm(), part.to_m.norm()) + part.radius_m; }

void check(const ToolPart& part) {
  const bool box = part.kind == ToolPart::Kind::box;
  const Point size_m = part.to_m - part.from_m;
  const bool solid = box ? size_m.minCoeff() > 0 && part.radius_m == 0
                         : part.radius_m > 0 && (part.kind == ToolPart::Kind::capsule || size_m.norm() > 0);
  const double reach_m = tip_to_end_m(part);
  if (solid && part.from_m.allFinite() && part.to_m.allFinite() && reach_m <= 2 * kToolReachMost_m) return;
  throw std::invalid_argument("a tool's part for a hand has a volume within " + text::to_text(2 * kToolReachMost_m) +
                              " m of its tip, got one from " + config::to_text(part.from_m) + " to " +
                              config::to_text(part.to_m) + " m with radius " + text::to_text(part.radius_m) + " m");
}

void check(const ToolPoint& point) {
  if (point.at_m.allFinite() && point.radius_m >= 0 && point.at_m.norm() + point.radius_m <= kToolReachMost_m) return;
  throw std::invalid_argument("a tool for a hand lies within " + text::to_text(kToolReachMost_m) +
                              " m of its tip, got a point at " + config::to_text(point.at_m) + " m with radius " +
                              text::to_text(point.radius_m) + " m");
}

}  // namespace

Tool::Tool(std::vector<ToolPoint> points, ToolContact contact, std::vector<ToolPart> parts)
    : points_(std::move(points)), parts_(std::move(parts)), contact_(contact) {
  if (points_.empty()) throw std::invalid_argument("a tool must have at least one point");
  if (points_.size() > kToolPointsMost) {
    throw std::invalid_argument("a tool may have at most " + std::to_string(kToolPointsMost) + " points, got " +
                                std::to_string(points_.size()) + ": a larger spacing_m is needed");
  }
  for (const ToolPoint& point : points_) {
    check(point);
    reach_m_ = std::max(reach_m_, point.at_m.norm() + point.radius_m);
    radius_m_max_ = std::max(radius_m_max_, point.radius_m);
  }
  if (parts_.size() > kToolPartsMost) {
    throw std::invalid_argument("a tool may have at most " + std::to_string(kToolPartsMost) + " parts, got " +
                                std::to_string(parts_.size()));
  }
  for (const ToolPart& part : parts_) check(part);
  nodes_.reserve(2 * points_.size());
  build(0, points_.size());
  // In the order of the tree, for the same digits at both ends.
  const auto count = static_cast<double>(points_.size());
  for (const ToolPoint& point : points_) centre_m_ += point.at_m / count;
  double squares_m2 = 0;
  for (const ToolPoint& point : points_) {
    const double distance_m = (point.at_m - centre_m_).norm();
    squares_m2 += distance_m * distance_m;
    reach_from_centre_m_ = std::max(reach_from_centre_m_, distance_m);
  }
  spread_m_ = std::max(kSpreadLeast_m, std::sqrt(squares_m2 / count));
  find_in_parts();
}

void Tool::find_in_parts() {
  in_part_.resize(points_.size());
  for (const ToolPart& part : parts_) {
    const std::unique_ptr<Shape> solid = make_solid(part, 0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const SurfacePoint found = nearest_at_first(*solid, points_[i].at_m);
      if (found.penetration_m > points_[i].radius_m - kRounding_m) in_part_[i] = true;
    }
  }
  all_in_parts_ = std::ranges::all_of(in_part_, std::identity());
}

void Tool::build(std::size_t first, std::size_t end) {
  const auto of = std::span(points_).subspan(first, end - first);
  Eigen::AlignedBox3d box_m;
  for (const ToolPoint& point : of) box_m.extend(point.at_m);
  Node node{.center_m = box_m.center(),
            .radius_m = 0,
            .first = static_cast<std::uint32_t>(first),
            .end = static_cast<std::uint32_t>(end),
            .after = 0};
  for (const ToolPoint& point : of)
    node.radius_m = std::max(node.radius_m, (point.at_m - node.center_m).norm() + point.radius_m);
  const std::size_t number = nodes_.size();
  nodes_.push_back(node);
  if (of.size() > kLeaf) {
    Eigen::Index axis = 0;
    (void)box_m.sizes().maxCoeff(&axis);
    // Stable, so that the points of a tool make the same tool again: sums have the same digits at both ends.
    std::ranges::stable_sort(of, {}, [axis](const ToolPoint& point) { return point.at_m[axis]; });
    build(first, first + of.size() / 2);
    build(first + of.size() / 2, end);
  }
  nodes_[number].after = static_cast<std::uint32_t>(nodes_.size());
}

void Tool::find_near(const Shape& shape, const ToolPose& pose, double margin_m,
                     std::vector<std::uint32_t>& near) const noexcept {
  for (std::uint32_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    if (shape.is_clear_of(pose * node.center_m, node.radius_m + margin_m)) {
      i = node.after;
      continue;
    }
    const bool leaf = node.after == ++i;
    for (std::uint32_t point = node.first; leaf && point < node.end; ++point) near.push_back(point);
  }
}

}  // namespace forcebound::scene
