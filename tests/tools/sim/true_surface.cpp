#include "tests/tools/sim/true_surface.hpp"

#include "forcebound/client/rendering/tool.hpp"

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
    client::Tool tool;
    tool.set_lever(scene_->scene().facts().tool_m);
    const control::Vector grip_m = device_.truth().position;
    const control::Vector tip_m = tool.at(grip_m, grip_m, tick.handle.orientation).tip;
    const scene::Answer here = scene_->answer(tip_m, tick.time, {}, false, tick.handle);
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
