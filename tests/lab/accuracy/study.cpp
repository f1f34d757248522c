#include "tests/lab/accuracy/study.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "forcebound/client/device/load_device.hpp"
#include "forcebound/server/scene/scene_parser.hpp"
#include "forcebound/server/session/answer_size.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/lab/accuracy/synchronised.hpp"

namespace forcebound::lab {
namespace {

using ScenePointer = std::shared_ptr<const server::Scene>;

// Of what is as near to the exact forces of contacts as numbers go.
constexpr int kTightIterations = 1000;
constexpr const char* kTightTolerance = "1e-14";
const std::string kTightText =
    std::to_string(kTightIterations) + " iterations at most, tolerance " + std::string(kTightTolerance);

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

/// Of the sweep's values, from coarse to fine.
std::vector<double> spacings_of(const Sweep& sweep) {
  if (sweep.values.size() < 2) {
    throw std::invalid_argument("a reference needs two values or more of " + sweep.key + ", or a scene that is exact");
  }
  std::vector<double> spacings;
  for (const std::string& value : sweep.values) {
    const auto spacing = spacing_of(sweep.key, value);
    if (!spacing) {
      throw std::invalid_argument(sweep.key + " has no order from coarse to fine (" + value + "): say what is exact");
    }
    if (!spacings.empty() && *spacing >= spacings.back()) {
      throw std::invalid_argument("values of " + sweep.key + " must go from coarse to fine, got " + value + " after " +
                                  sweep.values[spacings.size() - 1]);
    }
    spacings.push_back(*spacing);
  }
  return spacings;
}

/// All that is run: the settings, then what they are compared with where that is not among them.
struct Cast {
  std::vector<ScenePointer> scenes{};
  std::size_t settings = 0;
  std::size_t best = 0;
  std::optional<std::size_t> other{};  ///< as good in another way, which tells how uncertain the best is
  std::vector<double> spacings{};      ///< of the settings, if the best is what they tend to
  std::string why{};
};

Cast cast_of(const Study& study) {
  Cast cast{.scenes = variants_of(study)};
  cast.settings = cast.scenes.size();
  cast.best = cast.settings;
  if (study.reference) {
    cast.scenes.push_back(study.reference);
    cast.why = "scene '" + study.reference->facts().name + "', taken as exact";
  } else if (const auto tight = tight_solvers(study.scene_text, study.sweep.key)) {
    cast.scenes.push_back(server::parse_scene(tight->newton, study.scene_file));
    cast.scenes.push_back(server::parse_scene(tight->cg, study.scene_file));
    cast.other = cast.best + 1;
    cast.why = "newton, " + kTightText + "; its uncertainty by cg, " + kTightText;
  } else {
    cast.spacings = spacings_of(study.sweep);
    cast.best = cast.settings - 1;
    cast.other = cast.settings - 2;
  }
  return cast;
}

double relative_difference(const Along& run, const Along& reference) {
  const double size_N = rms(reference.forces);
  return size_N > 0 ? rms_difference(run.forces, reference.forces) / size_N : 0;
}

/// All runs of a study that are not behind a network.
struct Runs {
  std::vector<Along> free{};
  std::optional<Synchronised> synchronised{};

  [[nodiscard]] const std::vector<Along>& at_states() const { return synchronised ? synchronised->runs : free; }
};

Runs run_all(const Cast& cast, const std::vector<Vector>& positions_m, const time::Clock& clock) {
  Runs runs;
  for (const ScenePointer& scene : cast.scenes) runs.free.push_back(run_along(scene, positions_m, clock));
  runs.synchronised = run_synchronised(cast.scenes, cast.best, positions_m);
  return runs;
}

ReferenceModel reference_of(const Cast& cast, const Runs& runs) {
  const std::vector<Along>& at_states = runs.at_states();
  if (cast.spacings.empty()) {
    const double uncertainty = cast.other ? relative_difference(at_states[*cast.other], at_states[cast.best]) : 0;
    return {cast.scenes[cast.best], uncertainty, cast.why};
  }
  const auto levels = std::span(cast.scenes).first(cast.settings);
  return {levels, cast.spacings, std::span(at_states).first(cast.settings),
          runs.synchronised ? ReferenceModel::Levels::only_the_finest : ReferenceModel::Levels::extrapolated};
}

std::string trouble_of(std::size_t which, const Cast& cast, const Runs& runs, bool places_known) {
  const Along& free = runs.free[which];
  if (!free.trouble.empty()) return free.trouble;
  if (const std::string& trouble = runs.at_states()[which].trouble; !trouble.empty()) return trouble;
  const auto& reference = runs.free[cast.best].bodies;
  if (!free.bodies || !reference) return {};
  return body_trouble(*free.bodies, *reference, places_known);
}

/// What only runs at saved states tell.
void add_synchronised(StudyResult& result, const Cast& cast, const Runs& runs, const Synchronised& synchronised) {
  result.ticks_between_states = synchronised.ticks;
  const auto& bodies = runs.free[cast.best].bodies;
  if (cast.other) {
    result.velocity_uncertainty = synchronised.velocity_errors[*cast.other];
    result.free_uncertainty = relative_difference(runs.free[*cast.other], runs.free[cast.best]);
    const auto& other = runs.free[*cast.other].bodies;
    result.places_known = !bodies || !other || place_trouble(*other, *bodies).empty();
  }
}

StudyResult begin_result(const Study& study, const Cast& cast, const Runs& runs, const ReferenceModel& reference) {
  StudyResult result{.key = study.sweep.key,
                     .hand = make_harmonic_hand(study.motion, 3)->description(),
                     .fixed = study.fixed,
                     .reference_uncertainty = reference.uncertainty(),
                     .free_uncertainty = reference.uncertainty(),
                     .reference_order = reference.order(),
                     .reference_why = reference.why(),
                     .reference_bodies = runs.free[cast.best].bodies,
                     .answer_bytes = server::answer_bytes(*cast.scenes[cast.best])};
  if (runs.synchronised) add_synchronised(result, cast, runs, *runs.synchronised);
  result.reference_trouble = trouble_of(cast.best, cast, runs, result.places_known);
  return result;
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
  const Cast cast = cast_of(study);
  const ScenePointer best = cast.scenes[cast.best];
  if (best->parts() > 0) study.motion.on_surface_m = best->on_surface_m(0);
  const auto saved = run_device(settings_of(study, best, 0, 0), study.duration_s).true_positions;
  const Runs runs = run_all(cast, saved, clock);
  const ReferenceModel reference = reference_of(cast, runs);
  const auto right_in = [&](const std::vector<Along>& all) {
    return cast.spacings.empty() ? all[cast.best] : reference.along(std::span(all).first(cast.settings));
  };
  const Along right_at_states = right_in(runs.at_states());
  const Along right_free = right_in(runs.free);

  if (rms(right_free.forces) == 0) {
    throw std::runtime_error("the hand never feels anything: let it press deeper (--depth) or longer (--duration)");
  }
  StudyResult result = begin_result(study, cast, runs, reference);
  result.change_per_s = change_per_s(right_free.forces);
  for (std::size_t i = 0; i < cast.settings; ++i) {
    const Along& run = runs.free[i];
    StudiedSetting setting{.value = study.sweep.values[i],
                           .cost = run.cost,
                           .idle = idle_noise(run.cost.median_us, static_cast<int>(saved.size()), clock),
                           .per_step = run.per_step,
                           .at_states = state_error(runs.at_states()[i], right_at_states),
                           .velocity_at_states = runs.synchronised ? runs.synchronised->velocity_errors[i] : 0,
                           .free_force = relative_difference(run, right_free),
                           .bodies = run.bodies,
                           .trouble = trouble_of(i, cast, runs, result.places_known)};
    setting.at_states.work_J = run.work_J - right_free.work_J;
    const double turn_s = std::max(study.server_turn_least_s, run.cost.median_us * 1e-6);
    for (const double round_trip_s : study.round_trips_s) {
      DeviceRun lived = run_device(settings_of(study, cast.scenes[i], round_trip_s, turn_s), study.duration_s);
      reference.fill_in(lived);
      setting.behind.push_back(
          {round_trip_s, device_error(lived.ticks), lived.passivity_minimum_J, lived.turns_missed});
    }
    result.settings.push_back(std::move(setting));
  }
  return result;
}

std::optional<TightSolvers> tight_solvers(const std::string& scene_text, const std::string& key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) return std::nullopt;
  const std::string table = key.substr(0, dot);
  const std::string last = key.substr(dot + 1);
  const bool is_bodies = table == "bodies" || table.starts_with("body.");
  if (!is_bodies || (last != "solver" && last != "iterations" && last != "tolerance")) return std::nullopt;
  const auto with = [&](const std::string& solver) {
    const std::string tight =
        scene_variant(scene_variant(scene_text, table + ".iterations", std::to_string(kTightIterations)),
                      table + ".tolerance", kTightTolerance);
    return scene_variant(tight, table + ".solver", "\"" + solver + "\"");
  };
  return TightSolvers{.newton = with("newton"), .cg = with("cg")};
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
  const std::size_t begin = is_list ? value.find_first_not_of(' ', 1) : 0;
  if (begin == std::string::npos) return std::nullopt;
  const std::string first = is_list ? value.substr(begin, value.find_first_of(" ,]", begin) - begin) : value;
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
  if (const toml::array* const levels = scene["accuracy"]["levels"].as_array()) {
    Sweep sweep{.key = scene["accuracy"]["key"].value_or(std::string())};
    for (const toml::node& level : *levels) {
      std::ostringstream value;
      level.as_table()->at("value").visit([&](const auto& any) { value << any; });
      sweep.values.push_back(value.str());
    }
    return sweep;
  }
  if (const std::string name = first("tissue", "block"); !name.empty()) {
    return {"tissue." + name + ".shape.cells", {"[4, 4, 2]", "[6, 6, 3]", "[9, 9, 4]"}};
  }
  if (const std::string name = first("object", "distance_field"); !name.empty()) {
    return {"object." + name + ".shape.spacing_m", {"0.008", "0.004", "0.002", "0.001"}};
  }
  if (const toml::array* const bodies = scene["body"].as_array(); bodies != nullptr && !bodies->empty()) {
    const toml::table& body = *bodies->front().as_table();
    if (body.contains("shape")) return {"bodies.timestep_s", {"0.004", "0.002", "0.001", "0.0005", "0.00025"}};
    return {"body." + body["name"].value_or(std::string()) + ".iterations", {"1", "2", "3", "5", "10", "100"}};
  }
  throw std::invalid_argument("nothing in the scene has levels by itself: say what to try with --sweep KEY=V1,V2,...");
}

}  // namespace forcebound::lab
