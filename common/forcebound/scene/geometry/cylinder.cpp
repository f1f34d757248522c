#include "forcebound/scene/geometry/cylinder.hpp"

#include <cmath>

#include "forcebound/scene/geometry/last_normal.hpp"
#include "forcebound/scene/geometry/segment.hpp"

namespace forcebound::scene {
namespace {

class Cylinder final : public Shape {
 public:
  Cylinder(const LineSegment& segment, double radius_m) : segment_(segment), radius_m_(radius_m) {}

  SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    const Point from_middle = position_m - segment_.middle_m();
    const double along_m = from_middle.dot(segment_.axis());
    const Point out = from_middle - along_m * segment_.axis();
    const double distance_m = out.stableNorm();
    LastNormal& last = LastNormal::in(state);
    const bool on_axis = !(distance_m > kRounding * (radius_m_ + std::abs(along_m)));
    const Point radial = on_axis ? last.get_across(segment_.axis()) : last.keep(out / distance_m);
    const Point end = (along_m < 0 ? -1.0 : 1.0) * segment_.axis();

    const double beyond_side_m = distance_m - radius_m_;
    const double beyond_end_m = std::abs(along_m) - segment_.half_m();
    if (beyond_side_m > 0 && beyond_end_m > 0) {
      const double beyond_edge_m = std::hypot(beyond_side_m, beyond_end_m);
      return {(beyond_side_m * radial + beyond_end_m * end) / beyond_edge_m, -beyond_edge_m};
    }
    if (beyond_end_m > beyond_side_m) return {end, -beyond_end_m};
    return {radial, -beyond_side_m, on_axis};
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return is_clear_by_nearest(*this, center_m, radius_m);
  }

  ShapeFacts facts() const override {
    const Point across = (1 - segment_.axis().array().square()).max(0).sqrt();
    const Point half_m = segment_.half_m() * segment_.axis().cwiseAbs() + radius_m_ * across;
    return {.state_bytes = sizeof(LastNormal),
            .memory_bytes = sizeof *this,
            .cost_ns = 12,
            .bounds_m = bounds_about(segment_.middle_m(), half_m)};
  }

 private:
  LineSegment segment_;
  double radius_m_;
};

}  // namespace

std::unique_ptr<Shape> make_cylinder(const Point& from_m, const Point& to_m, double radius_m) {
  return std::make_unique<Cylinder>(LineSegment(from_m, to_m), radius_m);
}

ShapeKind cylinder_shape() {
  return straight_shape("cylinder", "A rod with flat ends; at least 2 axes, where it is a rectangle.", make_cylinder);
}

}  // namespace forcebound::scene
