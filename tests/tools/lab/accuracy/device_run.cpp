#include "tests/tools/lab/accuracy/device_run.hpp"

#include <functional>
#include <unordered_map>
#include <utility>

namespace forcebound::lab {
namespace {

/// Keeps what `device_error` needs of each tick.
class Recorder final : public record::TickSink {
 public:
  void on_force(const record::ForceRecord& record) noexcept override {
    arrived_[record.force.motion_sequence] = record.force.force;
  }

  void on_tick(const record::TickRecord& record) noexcept override {
    if (record.motion_sequence != 0) sent_[record.motion_sequence] = record.time;
    DeviceTick tick{.time = record.time, .request = record.request, .applied = record.applied};
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
  if (const auto audit = loop.device().audit()) recorder.run.passivity_minimum_J = audit->minimum_J;
  return std::move(recorder.run);
}

}  // namespace forcebound::lab
