#include "forcebound/scene/tool/tool.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/config/parameter.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

/// Of a leaf: asking about a ball costs as much as asking about a point.
constexpr std::size_t kLeaf = 4;

/// Of a tool that is as good as a point: turning it costs nothing.
constexpr double kSpreadLeast_m = 1e-3;

void check(const ToolPoint& point) {
  if (point.at_m.allFinite() && point.radius_m >= 0 && point.at_m.norm() + point.radius_m <= kToolReachMost_m) return;
  throw std::invalid_argument("a tool for a hand lies within " + text::to_text(kToolReachMost_m) +
                              " m of its tip, got a point at " + config::to_text(point.at_m) + " m with radius " +
                              text::to_text(point.radius_m) + " m");
}

}  // namespace

Tool::Tool(std::vector<ToolPoint> points, ToolContact contact) : points_(std::move(points)), contact_(contact) {
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
