#include "forcebound/scene/geometry/torus.hpp"

#include <Eigen/Geometry>

#include "forcebound/scene/geometry/last_normal.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

class Torus final : public Shape {
 public:
  Torus(const Point& center_m, const Point& axis, double major_radius_m, double minor_radius_m)
      : center_m_(center_m), axis_(axis.stableNormalized()), major_m_(major_radius_m), minor_m_(minor_radius_m) {}

  SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    const Point from_center = position_m - center_m_;
    const double along_m = from_center.dot(axis_);
    const Point across = from_center - along_m * axis_;
    const double across_m = across.stableNorm();
    const double least_m = kRounding * major_m_;
    LastNormal& last = LastNormal::in(state);
    const bool on_axis = !(across_m > least_m);
    const Point radial = on_axis ? last.get_across(axis_) : Point(across / across_m);

    const Point out = (across_m - major_m_) * radial + along_m * axis_;
    const double distance_m = out.stableNorm();
    if (!(distance_m > least_m)) return {last.get_across(axis_.cross(radial)), minor_m_ - distance_m, true};
    if (on_axis) return {out / distance_m, minor_m_ - distance_m, true};
    return last.along(out, distance_m, least_m, minor_m_ - distance_m);
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return is_clear_by_nearest(*this, center_m, radius_m);
  }

  ShapeFacts facts() const override {
    const Point across = (1 - axis_.array().square()).max(0).sqrt();
    return {.state_bytes = sizeof(LastNormal),
            .memory_bytes = sizeof *this,
            .cost_ns = 15,
            .bounds_m = bounds_about(center_m_, major_m_ * across + Point::Constant(minor_m_))};
  }

 private:
  Point center_m_;
  Point axis_;
  double major_m_;
  double minor_m_;
};

}  // namespace

std::unique_ptr<Shape> make_torus(const Point& center_m, const Point& axis, double major_radius_m,
                                  double minor_radius_m) {
  return std::make_unique<Torus>(center_m, axis, major_radius_m, minor_radius_m);
}

ShapeKind torus_shape() {
  return {.name = "torus",
          .description = "A ring; 3 axes.",
          .axes_least = 3,
          .parameters = {place_parameter("center_m", "its center"),
                         config::PointParameter{.key = "axis", .meaning = "through the hole", .is_direction = true},
                         positive_length("major_radius_m", "from the center to the middle of the tube"),
                         positive_length("minor_radius_m", "of the tube, less than the other")},
          .make = [](const config::Values& values, const ShapePurpose&) {
            const double major_m = values.number("major_radius_m");
            const double minor_m = values.number("minor_radius_m");
            if (!(minor_m < major_m)) {
              throw config::ValueError("minor_radius_m",
                                       "minor_radius_m must be < major_radius_m, got " + text::to_text(minor_m));
            }
            return make_torus(values.point("center_m"), values.point("axis"), major_m, minor_m);
          }};
}

}  // namespace forcebound::scene
