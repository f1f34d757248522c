#include "forcebound/scene/geometry/lathe.hpp"

#include <cmath>
#include <numbers>

#include "forcebound/scene/geometry/mesh_shape.hpp"

namespace forcebound::scene {
namespace {

constexpr int kSegmentsMax = 4096;

void check(const std::string& name, const std::vector<LathePoint>& profile, int segments) {
  if (profile.size() < 3) {
    throw GeometryError(name + ": a profile has at least 3 points, got " + std::to_string(profile.size()));
  }
  if (segments < 3 || segments > kSegmentsMax) {
    throw GeometryError(name + ": segments must be 3 to " + std::to_string(kSegmentsMax) + ", got " +
                        std::to_string(segments));
  }
  for (const LathePoint& point : profile) {
    if (!(point.radius_m >= 0)) throw GeometryError(name + ": a radius of the profile must be >= 0");
  }
}

/// Each point of the profile as a ring of vertices, or one vertex on the axis.
class Rings {
 public:
  Rings(const std::vector<LathePoint>& profile, int segments, const Point& origin_m) : segments_(segments) {
    for (const LathePoint& point : profile) {
      begins_.push_back(static_cast<std::uint32_t>(vertices_.size()));
      on_axis_.push_back(point.radius_m == 0);
      for (int i = 0; i < (on_axis_.back() ? 1 : segments); ++i) {
        const double angle = 2 * std::numbers::pi * i / segments;
        vertices_.emplace_back(
            origin_m + Point(point.radius_m * std::cos(angle), point.radius_m * std::sin(angle), point.height_m));
      }
    }
  }

  [[nodiscard]] bool on_axis(std::size_t point) const { return on_axis_[point]; }
  [[nodiscard]] std::uint32_t vertex(std::size_t point, int segment) const {
    return begins_[point] + (on_axis_[point] ? 0U : static_cast<std::uint32_t>(segment % segments_));
  }
  [[nodiscard]] const std::vector<Point>& vertices() const { return vertices_; }

 private:
  int segments_;
  std::vector<std::uint32_t> begins_;
  std::vector<bool> on_axis_;
  std::vector<Point> vertices_;
};

}  // namespace

TriangleMesh make_lathe(std::string name, const std::vector<LathePoint>& profile, int segments, const Point& origin_m) {
  check(name, profile, segments);
  const Rings rings(profile, segments, origin_m);
  std::vector<Triangle> triangles;
  for (std::size_t here = 0; here < profile.size(); ++here) {
    const std::size_t next = (here + 1) % profile.size();
    for (int i = 0; i < segments; ++i) {
      if (!rings.on_axis(here))
        triangles.push_back({rings.vertex(here, i), rings.vertex(here, i + 1), rings.vertex(next, i)});
      if (!rings.on_axis(next))
        triangles.push_back({rings.vertex(here, i + 1), rings.vertex(next, i + 1), rings.vertex(next, i)});
    }
  }
  // Skips edges along the axis: a triangle has at most one corner there.
  std::erase_if(triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  return {std::move(name), rings.vertices(), triangles};
}

ShapeKind lathe_shape() {
  return {
      .name = "lathe",
      .description = "A closed profile turned about the z axis, as a mesh: pots, bowls, rings; 3 axes.",
      .axes_least = 3,
      .geometry = GeometryKind::triangles,
      .parameters = {config::RowsParameter{
                         .key = "profile_m",
                         .meaning = "anticlockwise about its inside, with the radius to the right and the height up",
                         .accepted = "a list of [radius, height]",
                         .columns = 2},
                     config::NumberParameter{.key = "segments",
                                             .meaning = "around the axis",
                                             .preset = 128,
                                             .least = 3,
                                             .most = kSegmentsMax,
                                             .whole = true},
                     place_parameter("origin_m", "added to every vertex", Point::Zero())},
      .source = "profile_m",
      .make = [](const config::Values& values, const ShapePurpose& purpose) {
        if (purpose.geometry.mesh) return make_mesh(purpose.geometry.mesh, {.reach_m = purpose.reach_m});
        std::vector<LathePoint> profile;
        for (const std::vector<double>& row : values.rows("profile_m")) profile.push_back({row[0], row[1]});
        return make_mesh(std::make_shared<const TriangleMesh>(
                             make_lathe("lathe", profile, values.whole("segments"), values.point("origin_m"))),
                         {.reach_m = purpose.reach_m});
      }};
}

}  // namespace forcebound::scene
