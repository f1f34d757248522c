#include "tests/lab/accuracy/study.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "forcebound/client/device/load_device.hpp"
#include "forcebound/server/scene/scene_parser.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

using ScenePointer = std::shared_ptr<const server::Scene>;

std::vector<ScenePointer> variants_of(const Study& study) {
  std::vector<ScenePointer> scenes;
  for (const std::string& value : study.sweep.values) {
    scenes.push_back(server::parse_scene(scene_variant(study.scene_text, study.sweep.key, value), study.scene_file));
  }
  return scenes;
}

sim::ClosedLoop::Settings settings_of(const Study& study, const ScenePointer& scene, double round_trip_s,
                                      double server_turn_s) {
  sim::ClosedLoop::Settings settings{
      .device = client::load_device(study.device), .hand = {}, .law = study.law, .scene = scene};
  // What the server's model and the network do is asked here, not what an encoder does.
  settings.device.facts.encoder_step.setZero();
  const int dof = settings.device.facts.degrees_of_freedom();
  settings.make_hand = [motion = study.motion, dof] { return make_harmonic_hand(motion, dof); };
  settings.network.up.delay.mean = time::from_seconds(0.5 * round_trip_s);
  settings.network.down.delay.mean = time::from_seconds(0.5 * round_trip_s);
  settings.server_turn = time::from_seconds(server_turn_s);
  return settings;
}

ReferenceModel reference_of(const Study& study, const std::vector<ScenePointer>& scenes,
                            const std::vector<Along>& runs) {
  if (study.reference) return ReferenceModel(study.reference);
  if (scenes.size() < 2) {
    throw std::invalid_argument("a reference needs two values or more of " + study.sweep.key +
                                ", or a scene that is exact");
  }
  std::vector<double> spacings;
  for (const std::string& value : study.sweep.values) {
    const auto spacing = spacing_of(study.sweep.key, value);
    if (!spacing) {
      throw std::invalid_argument(study.sweep.key + " has no order from coarse to fine (" + value +
                                  "): say what is exact");
    }
    if (!spacings.empty() && *spacing >= spacings.back()) {
      throw std::invalid_argument("values of " + study.sweep.key + " must go from coarse to fine, got " + value +
                                  " after " + study.sweep.values[spacings.size() - 1]);
    }
    spacings.push_back(*spacing);
  }
  return {scenes, spacings, runs};
}

/// @param forces one a millisecond
double change_per_s(const Forces& forces) {
  if (forces.size() < 2) return 0;
  const Forces before(forces.begin(), forces.end() - 1);
  const Forces after(forces.begin() + 1, forces.end());
  const double size_N = rms(after);
  return size_N > 0 ? rms_difference(after, before) / size_N * 1e3 : 0;
}

}  // namespace

StudyResult carry_out(Study study, const time::Clock& clock) {
  const std::vector<ScenePointer> scenes = variants_of(study);
  const ScenePointer best = study.reference ? study.reference : scenes.back();
  if (best->parts() > 0) study.motion.on_surface_m = best->on_surface_m(0);
  const auto saved = run_device(settings_of(study, best, 0, 0), study.duration_s).true_positions;
  std::vector<Along> runs;
  runs.reserve(scenes.size());
  for (const ScenePointer& scene : scenes) runs.push_back(run_along(scene, saved, clock));
  const ReferenceModel reference = reference_of(study, scenes, runs);
  const Along right = study.reference ? run_along(study.reference, saved, clock) : reference.along(runs);

  StudyResult result{.key = study.sweep.key,
                     .hand = make_harmonic_hand(study.motion, 3)->description(),
                     .change_per_s = change_per_s(right.forces),
                     .reference_uncertainty = reference.uncertainty(),
                     .reference_order = reference.order(),
                     .reference_why = reference.why()};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Along& run = runs[i];
    StudiedSetting setting{.value = study.sweep.values[i],
                           .cost = run.cost,
                           .idle = idle_noise(run.cost.median_us, static_cast<int>(saved.size()), clock),
                           .at_states = state_error(run, right),
                           .trouble = run.trouble};
    const double turn_s = std::max(study.server_turn_least_s, run.cost.median_us * 1e-6);
    for (const double round_trip_s : study.round_trips_s) {
      DeviceRun lived = run_device(settings_of(study, scenes[i], round_trip_s, turn_s), study.duration_s);
      reference.fill_in(lived);
      setting.behind.push_back(
          {round_trip_s, device_error(lived.ticks), lived.passivity_minimum_J, lived.turns_missed});
    }
    result.settings.push_back(std::move(setting));
  }
  return result;
}

std::optional<std::size_t> best_setting(const StudyResult& result, std::size_t round_trip, double budget_us) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const StudiedSetting& setting = result.settings[i];
    if (!setting.trouble.empty() || setting.cost.median_us > budget_us) continue;
    const auto error = [&](std::size_t which) { return result.settings[which].behind[round_trip].error.total; };
    if (!best || error(i) < error(*best)) best = i;
  }
  return best;
}

std::optional<double> spacing_of(const std::string& key, const std::string& value) {
  const bool is_list = value.starts_with('[');
  const std::string first = is_list ? value.substr(1, value.find_first_of(",]") - 1) : value;
  const auto number = text::finite_number(first);
  if (!number || !(*number > 0)) return std::nullopt;
  const auto is_in = [&](const std::string& unit) {
    return key.ends_with("_" + unit) && !key.ends_with("_per_" + unit);
  };
  const bool is_size = !is_list && (is_in("m") || is_in("s"));
  return is_size ? *number : 1 / *number;
}

Sweep usual_sweep(const std::string& scene_text) {
  const toml::table scene = toml::parse(scene_text);
  const auto first = [&](const char* kind, const char* shape) -> std::string {
    const toml::array* all = scene[kind].as_array();
    if (all == nullptr) return {};
    for (const toml::node& node : *all) {
      const toml::table& table = *node.as_table();
      if (table["shape"]["kind"].value_or(std::string()) == shape) return table["name"].value_or(std::string());
    }
    return {};
  };
  if (const std::string name = first("tissue", "block"); !name.empty()) {
    return {"tissue." + name + ".shape.cells", {"[4, 4, 2]", "[6, 6, 3]", "[9, 9, 4]"}};
  }
  if (const std::string name = first("object", "distance_field"); !name.empty()) {
    return {"object." + name + ".shape.cell_m", {"0.008", "0.004", "0.002", "0.001"}};
  }
  if (scene.contains("bodies") || scene.contains("body")) {
    return {"bodies.timestep_s", {"0.004", "0.002", "0.001", "0.0005", "0.00025"}};
  }
  throw std::invalid_argument("nothing in the scene has levels by itself: say what to try with --sweep KEY=V1,V2,...");
}

}  // namespace forcebound::lab
