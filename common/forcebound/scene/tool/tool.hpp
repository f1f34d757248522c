#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/tool/tool_part.hpp"
#include "forcebound/scene/tool/tool_points.hpp"

namespace forcebound::scene {

/// Where a tool is: of its tip [m], and what turns the handle's axes into the scene's.
struct ToolPose {
  Point tip_m = Point::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();

  [[nodiscard]] Point operator*(const Point& in_handle_m) const noexcept { return tip_m + rotation * in_handle_m; }
};

/// How a tool touches what is solid.
enum class ToolContact : std::uint8_t {
  constraint,  ///< as one body with a simulated pose that stays outside (ToolProxy)
  penalty,     ///< by the depth of each point, on its own
};

/// A rigid tool with a shape: the points with which it touches, in a tree of balls about them. Immutable.
class Tool {
 public:
  /// A point's distance from a surface is wanted so far outside, where the simulated pose may go in one step.
  static constexpr double kAhead_m = 2e-3;

  /// @param parts those of its parts that are convex; what they hold is known without points
  /// @throws std::invalid_argument for no points, more than kToolPointsMost or kToolPartsMost, and one that is not
  /// finite, of a radius below zero, of no volume or further from the tip than kToolReachMost_m
  explicit Tool(std::vector<ToolPoint> points, ToolContact contact = ToolContact::constraint,
                std::vector<ToolPart> parts = {});

  [[nodiscard]] ToolContact contact() const noexcept { return contact_; }

  /// In the order of the tree: those near to each other follow each other.
  [[nodiscard]] std::span<const ToolPoint> points() const noexcept { return points_; }

  [[nodiscard]] std::span<const ToolPart> parts() const noexcept { return parts_; }
  /// Whether a point and its ball lie in a convex part.
  [[nodiscard]] bool is_in_part(std::uint32_t point) const noexcept { return in_part_[point]; }
  [[nodiscard]] bool all_in_parts() const noexcept { return all_in_parts_; }

  /// No point's ball reaches further from the tip [m].
  [[nodiscard]] double reach_m() const noexcept { return reach_m_; }
  /// Of points from a surface, for ShapePurpose [m].
  [[nodiscard]] double reach_of_points_m() const noexcept {
    return radius_m_max_ + (contact_ == ToolContact::constraint ? kAhead_m : 0);
  }

  /// The middle of its points, from the tip [m].
  [[nodiscard]] const Point& centre_m() const noexcept { return centre_m_; }
  /// RMS distance of its points from that, at least 1 mm [m].
  [[nodiscard]] double spread_m() const noexcept { return spread_m_; }
  /// The largest one [m].
  [[nodiscard]] double reach_from_centre_m() const noexcept { return reach_from_centre_m_; }

  /// Appends to `near` the numbers of all points that may be nearer to the solid than `margin_m`, in ascending order.
  /// @param near has room for all points
  ///
  /// Real time: noexcept, no allocation; asks the shape once for each ball of the tree that is not surely clear of it,
  /// and for the next beside that.
  void find_near(const Shape& shape, const ToolPose& pose, double margin_m,
                 std::vector<std::uint32_t>& near) const noexcept;

 private:
  struct Node {
    Point center_m;
    double radius_m;
    std::uint32_t first;  // of the points
    std::uint32_t end;
    std::uint32_t after;  // the next node that is not below this one; the first below follows it
  };

  void build(std::size_t first, std::size_t end);
  void find_in_parts();

  std::vector<ToolPoint> points_;
  std::vector<ToolPart> parts_;
  std::vector<bool> in_part_;  // each point
  bool all_in_parts_ = false;
  std::vector<Node> nodes_;
  ToolContact contact_;
  double reach_m_ = 0;
  double radius_m_max_ = 0;
  Point centre_m_ = Point::Zero();
  double spread_m_ = 0;
  double reach_from_centre_m_ = 0;
};

}  // namespace forcebound::scene
