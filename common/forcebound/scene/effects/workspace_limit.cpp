#include "forcebound/scene/effects/workspace_limit.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

class WorkspaceLimit final : public Effect {
 public:
  explicit WorkspaceLimit(const Values& values)
      : center_m_(values.point("center_m")),
        half_m_(0.5 * values.point("size_m")),
        radius_m_(values.number("radius_m")),
        stiffness_N_per_m_(values.number("stiffness_N_per_m")),
        damping_N_s_per_m_(values.number("damping_N_s_per_m")) {
    if (half_m_.minCoeff() == kUnlimited && radius_m_ == kUnlimited) {
      throw std::invalid_argument("'radius_m' or 'size_m' is missing: one of them at least is needed");
    }
  }

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const Point out_m = probe.position_m - center_m_;
    const Point inside_block_m = out_m.cwiseMax(-half_m_).cwiseMin(half_m_);
    push_back(out_m - inside_block_m, 0, probe, reaction);
    push_back(out_m, radius_m_, probe, reaction);
  }

  EffectFacts facts() const override {
    // Beyond both limits both push.
    const double limits = half_m_.minCoeff() < kUnlimited && radius_m_ < kUnlimited ? 2 : 1;
    return {.inputs = {.velocity = damping_N_s_per_m_ > 0},
            .stiffness_N_per_m = limits * stiffness_N_per_m_,
            .damping_N_s_per_m = limits * damping_N_s_per_m_,
            .cost_ns = 10};
  }

 private:
  /// Where `out_m` is longer than what is allowed.
  void push_back(const Point& out_m, double allowed_m, const Probe& probe, Reaction& reaction) const noexcept {
    const double distance_m = out_m.norm();
    if (!(distance_m > allowed_m)) return;
    const Point normal = out_m / distance_m;
    const double push_N =
        stiffness_N_per_m_ * (distance_m - allowed_m) + damping_N_s_per_m_ * probe.velocity_m_per_s.dot(normal);
    reaction.force_N -= std::max(0.0, push_N) * normal;
  }

  Point center_m_;
  Point half_m_;
  double radius_m_;
  double stiffness_N_per_m_;
  double damping_N_s_per_m_;
};

}  // namespace

EffectKind workspace_limit_effect() {
  return {.name = "workspace_limit",
          .purpose = "holds the device within a region",
          .law = "f = -n max(0, K d + B v.n) while the distance outside d > 0",
          .place = EffectPlace::space,
          .parameters =
              {place_parameter("center_m", "of the region"),
               positive_number("radius_m", "of a ball", kUnlimited, kUnlimited),
               PointParameter{.key = "size_m",
                              .meaning = "of a block along the axes, edge to edge",
                              .preset = Point::Constant(kUnlimited),
                              .each = {.least = 0}},
               positive_number("stiffness_N_per_m", "K", 1e9),
               NumberParameter{
                   .key = "damping_N_s_per_m", .meaning = "B, along the normal", .preset = 0, .least = 0, .most = 1e6}},
          .make = [](const Values& values) { return std::make_unique<WorkspaceLimit>(values); }};
}

}  // namespace forcebound::scene
