#include "tests/tools/lab/option_checks.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/lab/comparison/task.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kBesideIt = "; data and script go beside it, as .csv and .gnuplot";

void add_format(CLI::App& command, CLI::Option& figure, std::vector<std::string>& formats) {
  command.add_option("--format", formats, "draw each figure in this format too, beside its PNG")
      ->needs(&figure)
      ->delimiter(',')
      ->check(program::one_of("format", {"pdf", "svg"}))
      ->type_name("pdf|svg");
}

}  // namespace

CLI::Validator known_law() { return program::one_of("law", baselines::shipped_laws().names()); }

CLI::Validator known_device() {
  return program::accepted_by([](const std::string& device) {
    if (!device::names_a_file(device)) (void)device::load_device(device);
  });
}

CLI::Validator known_scene() {
  return program::accepted_by([](const std::string& scene) {
    if (!device::names_a_file(scene)) (void)server::scene_source(scene);
  });
}

CLI::Validator known_network() {
  return program::accepted_by([](const std::string& words) {
    if (!words.starts_with(kTraceWord)) (void)network_of(words);
  });
}

void expect_accepted(const scene::Scene& scene, const std::string& device) {
  const int has = device::load_device(device).facts.translations();
  if (scene.accepts(static_cast<std::uint32_t>(has))) return;
  throw std::invalid_argument("--device: '" + device + "' has " + std::to_string(has) + " degrees of freedom, scene '" +
                              scene.facts().name + "' accepts " + scene.facts().accepted_degrees_of_freedom());
}

void note_left_out(const std::vector<std::string>& recordings) {
  for (const std::string& name : recordings) {
    std::fprintf(stderr, "note: the recorded network %s is left out: it is not in FORCEBOUND_DATA\n", name.c_str());
  }
}

CLI::Option* add_rendering_option(CLI::App& command, bool& locally) {
  return command
      .add_option_function<std::string>(
          "--rendering", [&locally](const std::string& where) { locally = where == "local"; },
          "where forces are computed: remote, at the server; local, what can be at the client")
      ->check(program::one_of("rendering", {"remote", "local"}))
      ->type_name("WHERE")
      ->default_str("remote");
}

CLI::Option* add_figure(CLI::App& command, std::string& file, std::vector<std::string>& formats,
                        const std::string& what) {
  // Data and script have other extensions.
  const auto check = program::accepted_by([](const std::string& given) {
    if (!given.ends_with(".png")) throw std::invalid_argument("a figure is a FILE.png, got '" + given + "'");
  });
  CLI::Option* const figure =
      command.add_option("--figure", file, what + " into this file" + kBesideIt)->check(check)->type_name("FILE.png");
  add_format(command, *figure, formats);
  return figure;
}

CLI::Option* add_figures(CLI::App& command, std::string& folder, std::vector<std::string>& formats,
                         const std::string& what) {
  CLI::Option* const figures = command.add_option("--figures", folder, what + " into this folder" + kBesideIt)
                                   ->check(program::not_empty())
                                   ->type_name("FOLDER");
  add_format(command, *figures, formats);
  return figures;
}

CLI::Option* add_output(CLI::App& command, const std::string& name, std::string& file, const std::string& what) {
  return command.add_option(name, file, what)->check(program::not_empty());
}

}  // namespace forcebound::lab
