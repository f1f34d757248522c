#include "tests/tools/lab/accuracy/study.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/session/answer_size.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/accuracy/synchronised.hpp"

namespace forcebound::lab {
namespace {

using ScenePointer = std::shared_ptr<const scene::Scene>;

std::string list_of(const std::vector<server::SceneChange>& changes) {
  std::string list;
  for (const server::SceneChange& change : changes) {
    list += (list.empty() ? "" : ", ") + change.key + "=" + change.value;
  }
  return list;
}

std::vector<ScenePointer> variants_of(const Study& study) {
  if (is_session_key(study.sweep.key)) return {compile(study, {})};
  std::vector<ScenePointer> scenes;
  for (const std::string& value : study.sweep.values) scenes.push_back(compile(study, {{study.sweep.key, value}}));
  return scenes;
}

std::unique_ptr<const device::Operator> make_hand(const Study& study, const control::DeviceFacts& facts) {
  if (!study.hand.empty()) return device::make_operator(study.hand, facts);
  return make_harmonic_hand(study.motion, facts.translations());
}

std::string point_text(const Eigen::Vector3d& point_m) {
  return "(" + text::rounded(point_m.x()) + ", " + text::rounded(point_m.y()) + ", " + text::rounded(point_m.z()) +
         ") m";
}

std::string motion_text(const Study& study) {
  if (!study.hand.empty()) return "that moves as recorded: " + study.hand;
  const HarmonicMotion& motion = study.motion;
  const bool slides = motion.kind == HarmonicMotion::Kind::slide;
  const auto mm = [](double length_m) { return text::rounded(1e3 * length_m) + " mm"; };
  return (slides ? "that slides " + mm(motion.length_m) + " to and fro, " + mm(motion.depth_m) + " below"
                 : "that presses from " + mm(motion.clearance_m) + " above to " + mm(motion.depth_m) + " below") +
         " " + point_text(motion.on_surface_m) + ", " + text::rounded(motion.frequency_Hz) + " times a second";
}

/// The assumptions about the hand, as text.
std::string assumptions_of(const Study& study, const device::Operator& mover) {
  const device::Hand& hand = mover.hand();
  return "  The figures hold for a hand of " + text::rounded(hand.mass_kg) + " kg, " +
         text::rounded(hand.stiffness_N_per_m) + " N/m and " + text::rounded(hand.damping_N_s_per_m) +
         " N s/m, in every direction alike, " + motion_text(study) + ", on device " + study.device +
         " without its encoder's steps. Another hand meets other places, speeds and forces: --motion, --frequency, "
         "--depth, --device.\n";
}

struct Network {
  double round_trip_s = 0;
  double server_turn_s = 0;
};

sim::ClosedLoop::Settings settings_of(const Study& study, const SessionSettings& session, const ScenePointer& scene,
                                      const Network& network) {
  sim::ClosedLoop::Settings settings{
      .device = device::load_device(study.device), .hand = {}, .law = session.law, .scene = scene};
  // The study is about the server's model and the network, not about encoders.
  settings.device.facts.encoder_step.setZero();
  settings.make_hand = [&study, facts = settings.device.facts] { return make_hand(study, facts); };
  settings.network.up.delay.mean = time::from_seconds(0.5 * network.round_trip_s);
  settings.network.down.delay.mean = time::from_seconds(0.5 * network.round_trip_s);
  settings.server_turn = time::from_seconds(network.server_turn_s);
  settings.policy = session.policy;
  settings.renders_locally = session.renders_locally;
  return settings;
}

/// All scenes that are run: the settings, then the reference if it is not among them.
struct Cast {
  std::vector<ScenePointer> scenes{};
  std::size_t settings = 0;
  std::size_t best = 0;
  std::optional<std::size_t>
      other{};                     ///< an equally exact one by another method, which gives the reference's uncertainty
  std::vector<double> spacings{};  ///< of the settings, if the reference is their limit
  std::string why{};
};

/// @param study whose sweep is sorted from coarse to fine if the reference is its limit
Cast cast_of(Study& study) {
  const std::string& key = study.sweep.key;
  Cast cast;
  if (!study.reference && !is_session_key(key) && !is_level_of_detail(key) && !tight_solvers(key)) {
    cast.spacings = sort_to_fine(study.sweep);
  } else if (is_level_of_detail(key)) {
    (void)sort_to_fine(study.sweep);
  }
  cast.scenes = variants_of(study);
  cast.settings = cast.scenes.size();
  cast.best = cast.settings;
  if (study.reference) {
    cast.scenes.push_back(study.reference);
    cast.why = "scene '" + study.reference->facts().name + "', taken as exact";
  } else if (is_session_key(key)) {
    cast.best = 0;
    cast.why = "the scene itself: the settings differ only in the session";
  } else if (is_level_of_detail(key)) {
    cast.scenes.push_back(compile(study, {{key, "1"}}));
    cast.why = "the mesh as its file has it, taken as exact";
  } else if (const auto tight = tight_solvers(key)) {
    cast.scenes.push_back(compile(study, tight->newton));
    cast.scenes.push_back(compile(study, tight->cg));
    cast.other = cast.best + 1;
    cast.why = "newton, " + tight_text() + "; its uncertainty by cg, " + tight_text();
  } else {
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

Runs run_all(const Cast& cast, const std::vector<Vector>& positions_m, const time::Clock& clock,
             const std::function<void()>& step) {
  Runs runs;
  for (const ScenePointer& scene : cast.scenes) {
    runs.free.push_back(run_along(scene, positions_m, clock));
    step();
  }
  if (cast.scenes.size() > 1) runs.synchronised = run_synchronised(cast.scenes, cast.best, positions_m);
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

std::string trouble_of_run(std::size_t which, const Cast& cast, const Runs& runs, bool places_known) {
  const Along& free = runs.free[which];
  if (!free.trouble.empty()) return free.trouble;
  if (const std::string& trouble = runs.at_states()[which].trouble; !trouble.empty()) return trouble;
  const auto& reference = runs.free[cast.best].bodies;
  if (!free.bodies || !reference) return {};
  return body_trouble(*free.bodies, *reference, places_known);
}

/// Results that need runs at saved states.
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
  const auto hand = make_hand(study, device::load_device(study.device).facts);
  StudyResult result{.key = study.sweep.key,
                     .hand = hand->description(),
                     .assumptions = assumptions_of(study, *hand),
                     .fixed = list_of(study.fixed),
                     .session = to_text(study.session),
                     .server_step_us = 1e6 / study.session.server_rate_Hz,
                     .same_scene = is_session_key(study.sweep.key),
                     .reference_uncertainty = reference.uncertainty(),
                     .free_uncertainty = reference.uncertainty(),
                     .reference_order = reference.order(),
                     .reference_why = reference.why(),
                     .reference_bodies = runs.free[cast.best].bodies,
                     .answer_bytes = server::answer_bytes(*cast.scenes[cast.best])};
  if (runs.synchronised) add_synchronised(result, cast, runs, *runs.synchronised);
  result.reference_trouble = trouble_of_run(cast.best, cast, runs, result.places_known);
  return result;
}

/// The true forces along the saved states and along the free run.
struct Right {
  Along at_states;
  Along free;
};

Right right_of(const Cast& cast, const Runs& runs, const ReferenceModel& reference) {
  const auto in = [&](const std::vector<Along>& all) {
    return cast.spacings.empty() ? all[cast.best] : reference.along(std::span(all).first(cast.settings));
  };
  return {in(runs.at_states()), in(runs.free)};
}

/// @param forces one a millisecond
double change_per_s(const Forces& forces) {
  if (forces.size() < 2) return 0;
  const Forces before(forces.begin(), forces.end() - 1);
  const Forces after(forces.begin() + 1, forces.end());
  const double size_N = rms(after);
  return size_N > 0 ? rms_difference(after, before) / size_N * 1e3 : 0;
}

/// Of a setting over its round trips: the least age and the extrapolation's error.
struct Missed {
  double age_s = 0;
  double error = 0;
};

Missed mean_missed(const StudiedSetting& setting) {
  Missed mean;
  for (const StudiedSetting::Behind& behind : setting.behind) {
    mean.age_s += time::to_seconds(behind.error.least_age) / static_cast<double>(setting.behind.size());
    mean.error += behind.error.extrapolation.alone / static_cast<double>(setting.behind.size());
  }
  return mean;
}

/// Least squares of lines of one slope, one for each setting that worked: what is missed at any age, as of a body that
/// is touched, tells nothing about time. Of a single round trip through 0.
double extrapolation_per_s(const std::vector<StudiedSetting>& settings) {
  double by_age = 0;
  double age_squared = 0;
  for (const StudiedSetting& setting : settings) {
    if (!setting.trouble.empty()) continue;
    const Missed from = setting.behind.size() > 1 ? mean_missed(setting) : Missed{};
    for (const StudiedSetting::Behind& behind : setting.behind) {
      const double age_s = time::to_seconds(behind.error.least_age) - from.age_s;
      by_age += (behind.error.extrapolation.alone - from.error) * age_s;
      age_squared += age_s * age_s;
    }
  }
  return age_squared > 0 ? std::max(0.0, by_age / age_squared) : 0;
}

/// Results without a network, one setting for each scene.
std::vector<StudiedSetting> settings_alone(const Cast& cast, const Runs& runs, const StudyResult& result,
                                           const Right& right, const time::Clock& clock) {
  std::vector<StudiedSetting> settings;
  for (std::size_t i = 0; i < cast.settings; ++i) {
    const Along& run = runs.free[i];
    StudiedSetting setting{.value = {},
                           .cost = run.cost,
                           .idle = idle_noise(run.cost.median_us, static_cast<int>(run.forces.size()), clock),
                           .per_step = run.per_step,
                           .at_states = state_error(runs.at_states()[i], right.at_states),
                           .velocity_at_states = runs.synchronised ? runs.synchronised->velocity_errors[i] : 0,
                           .free_force = relative_difference(run, right.free),
                           .bodies = run.bodies,
                           .trouble = trouble_of_run(i, cast, runs, result.places_known)};
    setting.at_states.work_J = run.work_J - right.free.work_J;
    settings.push_back(std::move(setting));
  }
  return settings;
}

/// Since the first one that was rendered at the client: before, while the scene was handed over, forces are held. All
/// of them where none was.
std::span<const DeviceTick> since_rendered(const std::vector<DeviceTick>& ticks) {
  const auto first =
      std::ranges::find_if(ticks, [](const DeviceTick& tick) { return tick.rendering != record::ForceOrigin::held; });
  return first == ticks.end() ? std::span(ticks) : std::span(first, ticks.end());
}

/// One run behind each network, against the reference.
void live_behind(StudiedSetting& setting, const Study& study, const SessionSettings& session, const ScenePointer& scene,
                 const ReferenceModel& reference) {
  const double turn_s = std::max(session.server_turn_least_s(), setting.cost.median_us * 1e-6);
  for (const double round_trip_s : study.round_trips_s) {
    const Network network{.round_trip_s = round_trip_s, .server_turn_s = turn_s};
    DeviceRun lived = run_device(settings_of(study, session, scene, network), study.duration_s);
    reference.fill_in(lived);
    fill_in_own(lived, scene);
    setting.behind.push_back(
        {round_trip_s, device_error(since_rendered(lived.ticks)), lived.passivity_minimum_J, lived.turns_missed});
  }
}

/// The axis along which the first part's surface pushes outwards at its point; +z if it does along none.
Eigen::Vector3d out_of_surface(const ScenePointer& scene, const scene::Point& on_surface_m,
                               const HarmonicMotion& motion, const time::Clock& clock) {
  for (const int axis : {2, 0, 1}) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d out = sign * Eigen::Vector3d::Unit(axis);
      const std::vector<Vector> into{on_surface_m + motion.clearance_m * out, on_surface_m - motion.depth_m * out};
      if (run_along(scene, into, clock).forces.back().head<3>().dot(out) > 0) return out;
    }
  }
  return Eigen::Vector3d::UnitZ();
}

[[noreturn]] void refuse_numb(const Study& study, const scene::Scene& scene) {
  const std::string what = "the hand never touches the scene: let it ";
  if (study.hand.empty()) {
    throw std::runtime_error(what + "press deeper (--depth) or longer (--duration)");
  }
  std::string where;
  if (scene.parts() > 0) {
    const scene::Point point_m = scene.on_surface_m(0);
    where = "; a point of the scene's surface is " + point_text(point_m);
  }
  throw std::runtime_error(what + "go where the surface is (" + study.hand.substr(0, study.hand.find(',')) +
                           ",offset_x_m=..,offset_y_m=..,offset_z_m=..) or move longer (--duration)" + where);
}

}  // namespace

ScenePointer compile(const Study& study, const std::vector<server::SceneChange>& further) {
  std::vector<server::SceneChange> changes = study.fixed;
  changes.insert(changes.end(), further.begin(), further.end());
  try {
    return server::parse_changed_scene(study.scene_text, study.scene_file, changes);
  } catch (const server::SceneError& error) {
    if (changes.empty()) throw;
    throw server::SceneError(std::string(error.what()) + " (with " + list_of(changes) + ")");
  }
}

StudyResult carry_out(Study study, const time::Clock& clock, const std::function<void(double)>& progress) {
  const Cast cast = cast_of(study);
  const std::size_t steps = 1 + cast.scenes.size() + study.sweep.values.size();
  std::size_t done = 0;
  const auto step = [&] {
    if (progress) progress(static_cast<double>(++done) / static_cast<double>(steps));
  };
  // Check the session's settings before long runs.
  std::vector<SessionSettings> sessions(study.sweep.values.size(), study.session);
  const bool same_scene = is_session_key(study.sweep.key);
  for (std::size_t i = 0; i < sessions.size() && same_scene; ++i) {
    sessions[i] = with_session_key(study.session, study.sweep.key, study.sweep.values[i]);
  }
  const ScenePointer best = cast.scenes[cast.best];
  if (best->parts() > 0 && study.hand.empty()) {
    study.motion.on_surface_m = best->on_surface_m(0);
    study.motion.out = out_of_surface(best, study.motion.on_surface_m, study.motion, clock);
  }
  const auto saved = run_device(settings_of(study, study.session, best, {}), study.duration_s).true_positions;
  step();
  const Runs runs = run_all(cast, saved, clock, step);
  const ReferenceModel reference = reference_of(cast, runs);
  const Right right = right_of(cast, runs, reference);
  if (rms(right.free.forces) == 0) refuse_numb(study, *best);

  StudyResult result = begin_result(study, cast, runs, reference);
  result.change_per_s = change_per_s(right.free.forces);
  const std::vector<StudiedSetting> alone = settings_alone(cast, runs, result, right, clock);
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    const std::size_t which = same_scene ? 0 : i;
    StudiedSetting setting = alone[which];
    setting.value = study.sweep.values[i];
    live_behind(setting, study, sessions[i], cast.scenes[which], reference);
    result.settings.push_back(std::move(setting));
    step();
  }
  result.extrapolation_per_s = extrapolation_per_s(result.settings);
  return result;
}

std::optional<std::size_t> best_setting(const StudyResult& result, std::size_t round_trip, double budget_us) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const StudiedSetting& setting = result.settings[i];
    if (!setting.trouble.empty() || setting.cost.median_us > budget_us) continue;
    if (result.same_scene && !setting.stays_passive(round_trip)) continue;
    const auto error = [&](std::size_t which) { return result.settings[which].behind[round_trip].error.total; };
    if (!best || error(i) < error(*best)) best = i;
  }
  return best;
}

}  // namespace forcebound::lab
