#include "forcebound/scene/geometry/shape.hpp"

#include <cmath>
#include <limits>

#include "forcebound/scene/geometry/last_normal.hpp"

namespace forcebound::scene {
namespace {

using config::PointParameter;

class HalfSpace final : public Shape {
 public:
  HalfSpace(const Point& through_m, const Point& normal) : through_m_(through_m), normal_(normal.stableNormalized()) {}

  SurfacePoint nearest(const Point& position_m, std::byte*) const noexcept override {
    return {.normal = normal_, .penetration_m = (through_m_ - position_m).dot(normal_)};
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return is_clear_by_nearest(*this, center_m, radius_m);
  }

  ShapeFacts facts() const override { return {.memory_bytes = sizeof *this, .cost_ns = 3, .on_surface_m = through_m_}; }

 private:
  Point through_m_;
  Point normal_;
};

/// A filled ball, or all but that.
template <bool kHollow>
class Ball final : public Shape {
 public:
  Ball(const Point& center_m, double radius_m) : center_m_(center_m), radius_m_(radius_m) {}

  SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    const Point out = kHollow ? Point(center_m_ - position_m) : Point(position_m - center_m_);
    const double distance_m = out.stableNorm();
    const double penetration_m = kHollow ? distance_m - radius_m_ : radius_m_ - distance_m;
    return LastNormal::in(state).along(out, distance_m, kRounding * radius_m_, penetration_m);
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return is_clear_by_nearest(*this, center_m, radius_m);
  }

  ShapeFacts facts() const override {
    return {.state_bytes = sizeof(LastNormal),
            .memory_bytes = sizeof *this,
            .cost_ns = 12,
            .on_surface_m = center_m_ + radius_m_ * Point::UnitX(),
            .bounds_m = bounds_about(center_m_, Point::Constant(radius_m_))};
  }

 private:
  Point center_m_;
  double radius_m_;
};

class Box final : public Shape {
 public:
  Box(const Point& center_m, const Point& size_m) : center_m_(center_m), half_m_(0.5 * size_m) {}

  SurfacePoint nearest(const Point& position_m, std::byte*) const noexcept override {
    const Point from_center = position_m - center_m_;
    const Point outside_m = (from_center.cwiseAbs() - half_m_).cwiseMax(0.0);
    if (const double distance_m = outside_m.stableNorm(); distance_m > 0) {
      const Point sign = from_center.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
      return {.normal = outside_m.cwiseProduct(sign) / distance_m, .penetration_m = -distance_m};
    }
    SurfacePoint found{.normal = Point::UnitX(), .penetration_m = std::numeric_limits<double>::infinity()};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double depth_m = half_m_[axis] - std::abs(from_center[axis]);
      if (!(depth_m < found.penetration_m)) continue;
      found.penetration_m = depth_m;
      found.normal = (from_center[axis] < 0 ? -1.0 : 1.0) * Point::Unit(axis);
    }
    return found;
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return is_clear_by_nearest(*this, center_m, radius_m);
  }

  ShapeFacts facts() const override {
    return {.memory_bytes = sizeof *this,
            .cost_ns = 10,
            .on_surface_m = center_m_ + half_m_[0] * Point::UnitX(),
            .bounds_m = bounds_about(center_m_, half_m_)};
  }

 private:
  Point center_m_;
  Point half_m_;
};

ShapeKind ball_shape(std::string_view name, std::string_view description,
                     std::unique_ptr<Shape> (*make)(const Point& center_m, double radius_m)) {
  return {.name = name,
          .description = description,
          .parameters = {place_parameter("center_m", "its center"),
                         positive_length("radius_m", "from the center to the surface")},
          .make = [make](const config::Values& values, const ShapePurpose&) {
            return make(values.point("center_m"), values.number("radius_m"));
          }};
}

}  // namespace

SurfacePoint nearest_at_first(const Shape& shape, const Point& at_m) noexcept {
  LastNormal fresh{};
  return shape.nearest(at_m, reinterpret_cast<std::byte*>(&fresh));
}

bool is_clear_by_nearest(const Shape& shape, const Point& center_m, double radius_m) noexcept {
  return -nearest_at_first(shape, center_m).penetration_m > radius_m;
}

std::unique_ptr<Shape> make_half_space(const Point& through_m, const Point& normal) {
  return std::make_unique<HalfSpace>(through_m, normal);
}

std::unique_ptr<Shape> make_sphere(const Point& center_m, double radius_m) {
  return std::make_unique<Ball<false>>(center_m, radius_m);
}

std::unique_ptr<Shape> make_cavity(const Point& center_m, double radius_m) {
  return std::make_unique<Ball<true>>(center_m, radius_m);
}

std::unique_ptr<Shape> make_box(const Point& center_m, const Point& size_m) {
  return std::make_unique<Box>(center_m, size_m);
}

config::NumberParameter positive_length(std::string_view key, std::string_view meaning) {
  return config::positive_number(key, meaning, kLengthMost_m);
}

config::PointParameter place_parameter(std::string_view key, std::string_view meaning,
                                       const std::optional<Point>& preset) {
  return {.key = key, .meaning = meaning, .preset = preset, .each = {.least = -kLengthMost_m, .most = kLengthMost_m}};
}

void check_straight(const config::Values& values) {
  if (values.point("from_m") != values.point("to_m")) return;
  throw config::ValueError("to_m", "to_m must differ from from_m, got " + config::to_text(values.point("to_m")));
}

ShapeKind half_space_shape() {
  return {.name = "half_space",
          .description = "Everything behind a plane: a wall, a table.",
          .parameters = {place_parameter("through_m", "a point of the plane"),
                         PointParameter{.key = "normal", .meaning = "out of what is solid", .is_direction = true}},
          .make = [](const config::Values& values, const ShapePurpose&) {
            return make_half_space(values.point("through_m"), values.point("normal"));
          }};
}

ShapeKind sphere_shape() { return ball_shape("sphere", "A ball; a disc on two axes.", make_sphere); }

ShapeKind cavity_shape() {
  return ball_shape("cavity", "Everything but a ball: the inside of a sphere or circle.", make_cavity);
}

ShapeKind straight_shape(std::string_view name, std::string_view description, MakeStraight make) {
  return {.name = name,
          .description = description,
          .axes_least = 2,
          .parameters = {place_parameter("from_m", "one end of the axis"), place_parameter("to_m", "the other end"),
                         positive_length("radius_m", "around it")},
          .make = [make](const config::Values& values, const ShapePurpose&) {
            check_straight(values);
            return make(values.point("from_m"), values.point("to_m"), values.number("radius_m"));
          }};
}

ShapeKind box_shape() {
  return {.name = "box",
          .description = "A block along the axes.",
          .parameters = {place_parameter("center_m", "its center"),
                         PointParameter{.key = "size_m",
                                        .meaning = "from face to face, along the axes",
                                        .each = {.least = 0, .least_excluded = true, .most = kLengthMost_m},
                                        .rest = std::numeric_limits<double>::infinity()}},
          .make = [](const config::Values& values, const ShapePurpose&) {
            return make_box(values.point("center_m"), values.point("size_m"));
          }};
}

}  // namespace forcebound::scene
