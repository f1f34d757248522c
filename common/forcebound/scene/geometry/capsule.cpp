#include "forcebound/scene/geometry/capsule.hpp"

#include "forcebound/scene/geometry/last_normal.hpp"
#include "forcebound/scene/geometry/segment.hpp"

namespace forcebound::scene {
namespace {

class Capsule final : public Shape {
 public:
  Capsule(const LineSegment& segment, double radius_m) : segment_(segment), radius_m_(radius_m) {}

  SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept override {
    const Point from_middle = position_m - segment_.middle_m();
    const double along_m = std::clamp(from_middle.dot(segment_.axis()), -segment_.half_m(), segment_.half_m());
    const Point out = from_middle - along_m * segment_.axis();
    const double distance_m = out.stableNorm();
    // Rounding error of the position along the axis.
    const double least_m = kRounding * (radius_m_ + segment_.half_m());
    LastNormal& last = LastNormal::in(state);
    if (!(distance_m > least_m)) return {last.get_across(segment_.axis()), radius_m_ - distance_m, true};
    return last.along(out, distance_m, least_m, radius_m_ - distance_m);
  }

  bool is_clear_of(const Point& center_m, double radius_m) const noexcept override {
    return is_clear_by_nearest(*this, center_m, radius_m);
  }

  ShapeFacts facts() const override {
    const Point half_m = segment_.half_m() * segment_.axis().cwiseAbs() + Point::Constant(radius_m_);
    return {.state_bytes = sizeof(LastNormal),
            .memory_bytes = sizeof *this,
            .cost_ns = 10,
            .bounds_m = bounds_about(segment_.middle_m(), half_m)};
  }

 private:
  LineSegment segment_;
  double radius_m_;
};

}  // namespace

std::unique_ptr<Shape> make_capsule(const Point& from_m, const Point& to_m, double radius_m) {
  return std::make_unique<Capsule>(LineSegment(from_m, to_m), radius_m);
}

ShapeKind capsule_shape() { return straight_shape("capsule", "A rod with round ends; at least 2 axes.", make_capsule); }

}  // namespace forcebound::scene
