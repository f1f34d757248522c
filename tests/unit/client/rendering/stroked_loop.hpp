#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/record/tick_record.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/firm_device.hpp"

/// A hand that strokes the top of a scene with a firm device, whose scene may be rendered at the client.
namespace forcebound::sim {

using namespace std::chrono_literals;
using nlohmann::json;

inline constexpr const char* kFrictionPlane = R"(
[[object]]
name = 'plane'
shape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }
effects = ['surface', 'friction']
[object.surface]
stiffness_N_per_m = 10000
[object.friction]
static_coefficient = 0.3
dynamic_coefficient = 0.2
)";

/// Sees how the force came about on each tick.
class Watch final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    ++ticks;
    if (tick.rendering != record::ForceOrigin::held) {
      if (local == 0) first_local = tick.time;
      ++local;
    }
    if (tick.policy == record::ForcePolicy::fading) ++faded;
    if (tick.applied.norm() > 0.01 && first_force == Nanoseconds::zero()) first_force = tick.time;
    last = tick;
  }

  int ticks = 0;
  int local = 0;
  int faded = 0;
  Nanoseconds first_local{0};
  Nanoseconds first_force{0};
  record::TickRecord last;
};

inline ClosedLoop::Settings settings(const std::shared_ptr<const scene::Scene>& scene, const std::string& netem,
                                     bool local, const std::string& hand = "stroke:height_m=0.01,depth_m=0.004") {
  const auto parameters = netem.empty() ? netem::NetemParameters{} : netem::parse_netem(netem);
  return {.device = firm_device(),
          .hand = hand,
          .law = "fba-exact",
          .scene = scene,
          .network = {.up = parameters, .down = parameters, .trace = {}, .seed = 7},
          .settle_s = 0.5,
          .renders_locally = local};
}

inline json summary_of(ClosedLoop& loop) { return json::parse(loop.close().to_json()); }

/// Mean force over mean depth.
inline double displayed(const json& summary) {
  return summary["force_N"]["mean"].get<double>() / summary["penetration_m"]["mean"].get<double>();
}

}  // namespace forcebound::sim
