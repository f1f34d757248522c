#include "tests/tools/lab/accuracy/device_run.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <utility>

#include "forcebound/scene/scene_state.hpp"

namespace forcebound::lab {
namespace {

/// Keeps what `device_error` needs of each tick.
class Recorder final : public record::TickSink {
 public:
  void on_force(const record::ForceRecord& record) noexcept override {
    arrived_[record.force.motion_sequence] = record.force.answer.force;
  }

  void on_tick(const record::TickRecord& record) noexcept override {
    if (record.motion_sequence != 0) sent_[record.motion_sequence] = record.time;
    DeviceTick tick{.time = record.time,
                    .request = record.request,
                    .applied = record.applied,
                    .rendering = record.rendering,
                    .handle = record.handle};
    const auto sent = sent_.find(record.force_sequence);
    if (record.force_sequence != 0 && sent != sent_.end()) {
      tick.answered = true;
      tick.motion_time = sent->second;
      tick.arrived = arrived_[record.force_sequence];
    }
    run.ticks.push_back(std::move(tick));
    run.true_positions.push_back(where());
  }

  DeviceRun run;
  std::function<Vector()> where;

 private:
  std::unordered_map<std::uint64_t, Nanoseconds> sent_;
  std::unordered_map<std::uint64_t, Vector> arrived_;
};

}  // namespace

DeviceRun run_device(sim::ClosedLoop::Settings settings, double duration_s, std::vector<record::TickSink*> sinks) {
  Recorder recorder;
  sinks.push_back(&recorder);
  sim::ClosedLoop loop(std::move(settings), sinks);
  recorder.where = [&] { return loop.device().truth().position; };
  loop.run(time::from_seconds(duration_s));
  const server::ServerCounters counters = loop.server()->counters();
  if (counters.motions_received > 0) {
    recorder.run.turns_missed =
        static_cast<double>(counters.motions_superseded) / static_cast<double>(counters.motions_received);
  }
  recorder.run.summary = nlohmann::json::parse(loop.summary().to_json());
  recorder.run.law_faults = loop.session().totals().law_faults;
  if (const auto audit = loop.device().audit()) recorder.run.passivity_minimum_J = audit->minimum_J;
  return std::move(recorder.run);
}

void fill_in_own(DeviceRun& run, const std::shared_ptr<const scene::Scene>& scene) {
  const auto held = [](const DeviceTick& tick) { return tick.rendering == record::ForceOrigin::held; };
  if (std::ranges::all_of(run.ticks, held)) return;
  scene::SceneState state(scene, static_cast<std::uint32_t>(run.true_positions.front().rows()));
  // On held ticks too: what it keeps, such as where friction sticks, depends on all that came before.
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    run.ticks[i].own = state.answer(run.true_positions[i], run.ticks[i].time, {}, false, run.ticks[i].handle).force;
  }
}

}  // namespace forcebound::lab
