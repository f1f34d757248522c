#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/tools/lab/accuracy/levels_text.hpp"
#include "tests/tools/lab/accuracy/recommendation.hpp"
#include "tests/tools/lab/accuracy/round_trips.hpp"
#include "tests/tools/lab/accuracy/study_figure.hpp"
#include "tests/tools/lab/accuracy/study_markdown.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kPicture = "accuracy.png";

struct AccuracyOptions {
  std::string scene;
  std::string sweep;
  std::vector<std::string> fixed;
  std::string reference;
  std::vector<std::string> round_trips{"1ms", "5ms", "20ms", "50ms"};
  std::string motion = "press";
  HarmonicMotion harmonic{};
  bool has_harmonic = false;
  std::string device = "cartesian-3dof";
  SessionSettings session{};
  double hold_ms = 1e3 * time::to_seconds(client::LateForcePolicy{}.hold);
  double drop_ms = 1e3 * time::to_seconds(client::LateForcePolicy{}.drop);
  double duration_s = 2;
  double budget_us = std::numeric_limits<double>::infinity();
  std::string json;
  std::string levels;
  std::string readme;
  std::string figures;
  std::vector<std::string> formats;
};

std::vector<server::SceneChange> changes_of(const std::vector<std::string>& fixed) {
  std::vector<server::SceneChange> changes;
  for (const std::string& one : fixed) {
    const Sweep change = program::value_of("--set", [&] { return parse_sweep(one); });
    if (change.values.size() != 1) throw std::invalid_argument("--set takes one value, got '" + one + "'");
    if (is_session_key(change.key)) {
      throw std::invalid_argument("--set is for keys of the scene; for '" + change.key + "' use its own option");
    }
    changes.push_back({change.key, change.values.front()});
  }
  return changes;
}

/// A sweep of a key that is in the scene or of the session.
Sweep checked_sweep(const std::string& words) {
  Sweep sweep = parse_sweep(words);
  const bool of_scene = sweep.key.find('.') != std::string::npos;
  if (of_scene || is_session_key(sweep.key)) return sweep;
  throw std::invalid_argument("unknown key '" + sweep.key + "'" + text::suggestion(sweep.key, session_keys()) +
                              "; keys of the scene have dots: object.NAME.surface.stiffness_N_per_m");
}

/// @throws std::invalid_argument if the scene, which is right as it is, refuses the option's changes
void check_changes(const Study& study, const char* option, const std::vector<server::SceneChange>& further) {
  try {
    (void)compile(study, further);
  } catch (const server::SceneError& error) {
    throw std::invalid_argument(std::string(option) + ": " + error.what());
  }
}

bool is_replay(const std::string& motion) { return motion.starts_with("replay:"); }

std::string check_motion(std::string& motion) {
  if (motion == "press" || motion == "slide" || is_replay(motion)) return {};
  return "must be press, slide or replay:FILE.csv, got '" + motion + "'";
}

/// @throws server::SceneError as the server, naming file and line
Study study_of(const AccuracyOptions& options) {
  const server::SceneSource source = server::scene_source(options.scene);
  expect_accepted(*server::parse_scene(source.text, source.file), options.device);
  Study study{.scene_text = source.text,
              .scene_file = source.file,
              .sweep = {},
              .fixed = changes_of(options.fixed),
              .round_trips_s = parse_round_trips_s(options.round_trips),
              .motion = options.harmonic,
              .device = options.device,
              .session = options.session,
              .duration_s = options.duration_s};
  check_changes(study, "--set", {});
  study.sweep = options.sweep.empty() ? usual_sweep(source.text)
                                      : program::value_of("--sweep", [&] { return checked_sweep(options.sweep); });
  if (!is_session_key(study.sweep.key)) {
    check_changes(study, "--sweep", {{study.sweep.key, study.sweep.values.front()}});
  }
  study.session.policy = {.hold = time::from_seconds(1e-3 * options.hold_ms),
                          .drop = time::from_seconds(1e-3 * options.drop_ms)};
  program::value_of("--hold, --drop", [&] { study.session.policy.validate(); });
  study.motion.kind = options.motion == "slide" ? HarmonicMotion::Kind::slide : HarmonicMotion::Kind::press;
  if (is_replay(options.motion)) study.hand = options.motion;
  if (is_replay(options.motion) && options.has_harmonic) {
    throw std::invalid_argument("--frequency and --depth are for press and slide; a recorded hand has offset_z_m=.. " +
                                std::string("and scale=.. after its file"));
  }
  if (!options.reference.empty()) study.reference = server::load_scene(options.reference);
  return study;
}

nlohmann::ordered_json carried_out(const AccuracyOptions& options) {
  program::Progress progress;
  const StudyResult result = carry_out(study_of(options), time::SteadyClock(),
                                       [&](double done) { progress.report(done, "running the settings"); });
  progress.clear();
  std::printf("%s\n%s", text::printable_lines(to_text(result)).c_str(),
              text::wrapped(recommendation(result, options.budget_us) + what_does_not_matter(result), 2).c_str());
  if (!options.levels.empty()) text::write_file(options.levels, levels_text(result));
  return to_json(result);
}

/// What --json wrote of an earlier study.
nlohmann::ordered_json read_study(const std::string& file) {
  auto study = nlohmann::ordered_json::parse(text::read_file(file), nullptr, false);
  if (!study.is_object() || !study.contains("settings")) {
    throw std::runtime_error(file + ": not a study; expected the output of --json");
  }
  return study;
}

bool is_written(const std::string& scene) { return scene.ends_with(".json"); }

void accuracy(const AccuracyOptions& options) {
  if (is_written(options.scene) && !(options.sweep.empty() && options.fixed.empty() && options.levels.empty())) {
    throw std::invalid_argument(options.scene +
                                " is a study that was carried out: --sweep, --set and --levels need a scene");
  }
  (void)parse_round_trips_s(options.round_trips);  // wrong use comes before what is wrong with a file
  results::prepare({.inputs = {options.scene, options.reference, options.device, device::recorded_hand(options.motion)},
                    .files = {options.json, options.levels},
                    .page = options.readme,
                    .marks = kAccuracyMarks,
                    .folder = options.figures,
                    .figures = results::pictures_in(options.figures, {kPicture}),
                    .formats = options.formats});
  const auto study = is_written(options.scene) ? read_study(options.scene) : carried_out(options);
  if (!options.json.empty()) text::write_file(options.json, study.dump(2) + '\n');
  if (!options.readme.empty()) {
    text::write_file(options.readme, results::page_with(options.readme, kAccuracyMarks, to_markdown(study)));
  }
  if (options.figures.empty()) return;
  const auto drawn =
      results::draw(study_figure(study), std::filesystem::path(options.figures) / kPicture, options.formats);
  std::printf("\nFigure: %s\n", drawn.c_str());
}

std::string footer() {
  return "Recommended behind each network is the most exact setting, unless a rougher one is less wrong at the device "
         "and saves time: at least " +
         text::rounded(100 * kTimeShareThatCounts) +
         " % of the server's step (1 ms at --rate 1000) off the median, and at least the interquartile range of the "
         "steps' times and of an idle loop's. Nothing is recommended where the errors are below the reference's own "
         "uncertainty. A force that points more than " +
         text::rounded(kDirectionWarning_deg) +
         " degrees aside (p95) is warned of. All figures hold for the hand that they were taken with, which the output "
         "names.\n"
         "\n"
         "Examples:\n"
         "  forcebound-lab accuracy palpation --rtt 1,20\n"
         "  forcebound-lab accuracy sphere --sweep law=fba-less,fba-more,fba-exact";
}

void add_session(CLI::App& command, AccuracyOptions& options) {
  command.add_option("--law", options.session.law, "as the client's")
      ->type_name("LAW|FILE.so")
      ->transform(known_law())
      ->capture_default_str();
  command.add_option("--hold", options.hold_ms, "age up to which a force is applied unchanged, as in the client")
      ->check(program::number_within(0))
      ->type_name("MS")
      ->capture_default_str();
  command
      .add_option("--drop", options.drop_ms,
                  "age from which a force is replaced by zero, as in the client; it fades until then")
      ->check(program::number_within(0))
      ->type_name("MS")
      ->capture_default_str();
  add_rendering_option(command, options.session.renders_locally);
  command.add_option("--rate", options.session.server_rate_Hz, "most answers of the server per second")
      ->check(program::number_above_zero())
      ->type_name("HZ")
      ->capture_default_str();
}

/// Which scenes are compared with which.
void add_scenes(CLI::App& command, AccuracyOptions& options) {
  command
      .add_option(
          "--sweep", options.sweep,
          "a key of the scene and its values, from coarse to fine or back: "
          "tissue.pad.shape.cells=[2,2,1],[4,4,2],[8,8,4]; object.NAME.shape.detail=0.03,0.1,1; "
          "or of the session, with the scene unchanged: law=none,fba-less,fba-more,fba-exact; "
          "hold_ms=0,50,250; drop_ms=300,1000; rate_Hz=20,50,1000; rendering=remote,local. Default: the scene's own "
          "levels")
      ->type_name("KEY=V1,V2,...");
  command
      .add_option("--set", options.fixed,
                  "a key of the scene and another value for all runs, before the sweep; may be repeated: "
                  "bodies.solver='\"pgs\"'")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command
      .add_option("--reference", options.reference,
                  "a scene whose force is exact; default: the limit of the finest levels; for a solver of "
                  "bodies a tight Newton's method")
      ->check(known_scene())
      ->type_name("NAME|FILE.toml");
}

void add_outputs(CLI::App& command, AccuracyOptions& options) {
  program::add_output(command, "--json", options.json, "write all figures to this file")->type_name("FILE.json");
  program::add_output(command, "--levels", options.levels,
                      "write the results to this file as the table [accuracy] of a scene with accuracy = \"auto\"")
      ->type_name("FILE.toml");
  program::add_output(command, "--readme", options.readme, "put a table between the marks of this file")
      ->type_name("PAGE.md");
  program::add_figures(command, options.figures, options.formats, "draw the errors");
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto options = std::make_shared<AccuracyOptions>();
  CLI::App* command = app.add_subcommand(
      "accuracy", "Error of a scene's force at the device over the time that its settings cost, behind networks");
  command->footer(footer());
  command
      ->add_option("SCENE", options->scene,
                   "name or FILE.toml; or FILE.json that --json wrote: then nothing is run, only written")
      ->required()
      ->check(program::accepted_by([](const std::string& scene) {
        if (!is_written(scene) && !device::names_a_file(scene)) (void)server::scene_source(scene);
      }));
  add_scenes(*command, *options);
  command->add_option("--rtt", options->round_trips, "round trips: 1ms,5ms,0.02s or bare milliseconds")
      ->delimiter(',')
      ->type_name("TIME,TIME,...")
      ->default_str("1ms,5ms,20ms,50ms");
  command
      ->add_option("--motion", options->motion,
                   "of the hand: press or slide on the scene's surface, or a recorded hand at its recorded positions: "
                   "replay:FILE.csv with columns time_s,x_m,y_m,z_m. To bring it where the scene's surface is: "
                   "replay:FILE.csv,offset_x_m=0,offset_y_m=0,offset_z_m=-0.004,scale=0.5")
      ->check(CLI::Validator(check_motion, ""))
      ->type_name("MOTION")
      ->capture_default_str();
  const CLI::Option* const frequency =
      command->add_option("--frequency", options->harmonic.frequency_Hz, "frequency of press and slide")
          ->check(program::number_above_zero())
          ->type_name("HZ")
          ->capture_default_str();
  const CLI::Option* const depth =
      command->add_option("--depth", options->harmonic.depth_m, "target depth of press and slide")
          ->check(program::number_above_zero())
          ->type_name("M")
          ->capture_default_str();
  command->add_option("--device", options->device, "as the client's")
      ->check(known_device())
      ->type_name("NAME|FILE.toml")
      ->capture_default_str();
  add_session(*command, *options);
  command->add_option("--duration", options->duration_s, "virtual seconds of each run")
      ->check(program::number_above_zero())
      ->type_name("SECONDS")
      ->capture_default_str();
  command->add_option("--budget", options->budget_us, "longest step to recommend")
      ->check(program::number_above_zero())
      ->type_name("US");
  add_outputs(*command, *options);
  command->callback([options, frequency, depth] {
    options->has_harmonic = frequency->count() + depth->count() > 0;
    accuracy(*options);
  });
}

}  // namespace forcebound::lab
