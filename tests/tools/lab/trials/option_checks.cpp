#include "tests/tools/lab/trials/option_checks.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/lab/trials/task.hpp"

namespace forcebound::lab {

CLI::Validator known_law() { return program::replaced_by(law_plugin::law_of_option); }

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

void report_left_out(const std::vector<std::string>& recordings) {
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

}  // namespace forcebound::lab
