#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/scene/scene_library.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/lab/above_zero.hpp"
#include "tests/lab/accuracy/levels_text.hpp"
#include "tests/lab/accuracy/study_markdown.hpp"
#include "tests/lab/accuracy/study_text.hpp"
#include "tests/lab/commands.hpp"

namespace forcebound::lab {
namespace {

struct Options {
  std::string scene;
  std::string sweep;
  std::vector<std::string> fixed;
  std::string reference;
  std::vector<double> round_trips_ms{1, 5, 20, 50};
  std::string motion = "press";
  HarmonicMotion harmonic{};
  std::string device = "cartesian-3dof";
  std::string law = "fba-exact";
  double duration_s = 2;
  double rate_Hz = 1000;
  bool recommend = false;
  double budget_us = std::numeric_limits<double>::infinity();
  std::string json;
  std::string levels;
  std::string readme;
  std::string figures;
};

std::string with_fixed(std::string scene_text, const std::vector<std::string>& fixed) {
  for (const std::string& one : fixed) {
    const Sweep change = parse_sweep(one);
    if (change.values.size() != 1) throw std::invalid_argument("--set takes one value, got '" + one + "'");
    scene_text = scene_variant(scene_text, change.key, change.values.front());
  }
  return scene_text;
}

Study study_of(const Options& options) {
  const server::SceneSource source = server::scene_source(options.scene);
  const std::string text = with_fixed(source.text, options.fixed);
  Study study{.scene_text = without_levels(text),
              .scene_file = source.file,
              .sweep = options.sweep.empty() ? usual_sweep(text) : parse_sweep(options.sweep),
              .fixed = text::join(options.fixed),
              .motion = options.harmonic,
              .device = options.device,
              .law = options.law,
              .duration_s = options.duration_s,
              .server_turn_least_s = options.rate_Hz < 1000 ? 1 / options.rate_Hz : 0};
  for (const double ms : options.round_trips_ms) study.round_trips_s.push_back(ms * 1e-3);
  study.motion.kind = options.motion == "slide" ? HarmonicMotion::Kind::slide : HarmonicMotion::Kind::press;
  if (!options.reference.empty()) study.reference = server::load_scene(options.reference);
  return study;
}

void accuracy(const Options& options) {
  const StudyResult result = carry_out(study_of(options), time::SteadyClock());
  std::printf("%s\n%s", to_text(result).c_str(), recommendation(result, options.budget_us).c_str());
  if (!options.json.empty()) text::write_file(options.json, to_json(result).dump(2) + '\n');
  if (!options.readme.empty()) {
    text::write_file(options.readme,
                     with_between_marks(text::read_file(options.readme), kAccuracyMarks, to_markdown(to_json(result))));
  }
  if (!options.levels.empty()) text::write_file(options.levels, levels_text(result));
  if (options.figures.empty()) return;
  std::filesystem::create_directories(options.figures);
  const auto png = std::filesystem::path(options.figures) / "accuracy.png";
  draw(result, "What accuracy costs in time", png);
  std::printf("\nFigure: %s\n", png.c_str());
}

}  // namespace

void add_accuracy(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "accuracy", "How wrong a scene's force is at the device, over what its settings cost in time, behind networks");
  command->add_option("SCENE", options->scene, "name or FILE.toml")->required();
  command
      ->add_option("--sweep", options->sweep,
                   "a key of the scene and what to try, from coarse to fine:\n"
                   "tissue.pad.shape.cells=[2,2,1],[4,4,2],[8,8,4]; default: what the scene has")
      ->type_name("KEY=V1,V2,...");
  command
      ->add_option("--set", options->fixed,
                   "a key of the scene and another value for all runs, before the sweep; may be repeated:\n"
                   "bodies.solver='\"pgs\"'")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("--reference", options->reference,
                   "a scene whose force is exact; default: what the finest levels tend to; for a solver of\n"
                   "bodies Newton's method as far as it goes")
      ->type_name("NAME|FILE");
  command->add_option("--rtt", options->round_trips_ms, "round trips")->delimiter(',')->type_name("MS,MS,...");
  command->add_option("--motion", options->motion, "of the hand on the surface at the origin")
      ->check(CLI::IsMember({"press", "slide"}))
      ->capture_default_str();
  command->add_option("--frequency", options->harmonic.frequency_Hz, "of that motion")
      ->check(above_zero())
      ->type_name("HZ")
      ->capture_default_str();
  command->add_option("--depth", options->harmonic.depth_m, "of that motion, as far as the hand wants")
      ->check(above_zero())
      ->type_name("M")
      ->capture_default_str();
  command->add_option("--device", options->device, "as the client's")->capture_default_str();
  command->add_option("--law", options->law, "as the client's")
      ->check(CLI::IsMember(control::shipped_laws().names()))
      ->capture_default_str();
  command->add_option("--duration", options->duration_s, "virtual seconds of each run")
      ->check(above_zero())
      ->capture_default_str();
  command->add_option("--rate", options->rate_Hz, "how often the server answers, at most")
      ->check(above_zero())
      ->type_name("HZ")
      ->capture_default_str();
  command->add_option("--budget", options->budget_us, "recommend nothing that takes longer")
      ->check(above_zero())
      ->type_name("US");
  command->add_option("--json", options->json, "write all figures to this file")->type_name("FILE");
  command
      ->add_option("--levels", options->levels,
                   "write what was found to this file as the [accuracy] of a scene, which then picks for itself")
      ->type_name("FILE");
  command->add_option("--readme", options->readme, "put a table between the marks of this file")
      ->type_name("README.md");
  command->add_option("--figures", options->figures, "draw into this directory")->type_name("DIR");
  command->callback([options] { accuracy(*options); });
}

}  // namespace forcebound::lab
