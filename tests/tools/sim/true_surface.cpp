#include "tests/tools/sim/true_surface.hpp"

namespace forcebound::sim {

TrueSurface::TrueSurface(const std::shared_ptr<const scene::Scene>& scene, const device::SimulatedDevice& device)
    : device_(device) {
  const auto rows = static_cast<std::uint32_t>(device.facts().translations());
  if (scene && scene->dynamic_models().empty() && scene->accepts(rows)) scene_.emplace(scene, rows);
}

void TrueSurface::hand_on_to(const std::vector<record::TickSink*>& sinks) {
  sinks_.insert(sinks_.end(), sinks.begin(), sinks.end());
}

void TrueSurface::on_tick(const record::TickRecord& tick) noexcept {
  tick_ = tick;
  if (scene_) {
    const scene::Answer here = scene_->answer(device_.truth().position, tick.time);
    tick_.contact = here.penetration_m > 0;
    tick_.penetration_m = here.penetration_m;
    tick_.displayed_N = tick_.contact ? tick.applied.dot(here.contact_normal) : 0;
  }
  for (record::TickSink* sink : sinks_) sink->on_tick(tick_);
}

void TrueSurface::on_force(const record::ForceRecord& force) noexcept {
  for (record::TickSink* sink : sinks_) sink->on_force(force);
}

}  // namespace forcebound::sim
