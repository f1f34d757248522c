#include "forcebound/server/effects/surface.hpp"

#include <algorithm>

namespace forcebound::server {
namespace {

class Surface final : public Effect {
 public:
  Surface(double stiffness_N_per_m, double damping_N_s_per_m)
      : stiffness_N_per_m_(stiffness_N_per_m), damping_N_s_per_m_(damping_N_s_per_m) {}

  Point force_N(const Probe& probe) const noexcept override {
    const double leaving_m_per_s = probe.velocity_m_per_s.dot(probe.normal);
    const double push_N = stiffness_N_per_m_ * probe.penetration_m - damping_N_s_per_m_ * leaving_m_per_s;
    return std::max(0.0, push_N) * probe.normal;
  }

  bool needs_velocity() const noexcept override { return damping_N_s_per_m_ > 0; }

 private:
  double stiffness_N_per_m_;
  double damping_N_s_per_m_;
};

}  // namespace

EffectKind surface_effect() {
  return {.name = "surface",
          .law = "f = n max(0, K d - B v.n) while the depth d > 0",
          .parameters = {{.key = "stiffness_N_per_m", .preset = {}, .least = 0, .least_excluded = true, .most = 1e9},
                         {.key = "damping_N_s_per_m", .preset = 0, .least = 0, .most = 1e6}},
          .make = [](std::span<const double> values) -> std::unique_ptr<Effect> {
            return std::make_unique<Surface>(values[0], values[1]);
          }};
}

}  // namespace forcebound::server
