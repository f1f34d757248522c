#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace forcebound::scene {
class Scene;
}  // namespace forcebound::scene

/// Options that several commands of the lab have, and their checks.
namespace forcebound::lab {

/// A law that ships, or the file of one, in place of which comes its name: for CLI::Option::transform.
CLI::Validator known_law();
/// A device that ships, or a file.
CLI::Validator known_device();
/// A scene that ships, or a file.
CLI::Validator known_scene();
/// none, netem's words, or trace:FILE.
CLI::Validator known_network();

/// To be called with --device. @throws std::invalid_argument if the scene does not accept the device's degrees of
/// freedom
void expect_accepted(const scene::Scene& scene, const std::string& device);

/// Notes on stderr the recorded networks that are not in FORCEBOUND_DATA.
void report_left_out(const std::vector<std::string>& recordings);

/// --rendering remote|local, remote unless given. @param locally whether it is local
CLI::Option* add_rendering_option(CLI::App& command, bool& locally);

}  // namespace forcebound::lab
