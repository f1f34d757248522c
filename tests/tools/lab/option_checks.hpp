#pragma once

#include <string>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

/// Options that several commands of the lab have, and their checks.
namespace forcebound::lab {

/// A law that ships.
CLI::Validator known_law();
/// A device that ships, or a file.
CLI::Validator known_device();
/// A scene that ships, or a file.
CLI::Validator known_scene();
/// none, netem's words, or trace:FILE.
CLI::Validator known_network();

/// --figure FILE.png. @param what "draw the ratios"
CLI::Option* add_figure(CLI::App& command, std::string& file, const std::string& what);
/// --figures FOLDER.
CLI::Option* add_figures(CLI::App& command, std::string& folder, const std::string& what);
/// An option of a file that is written, such as --json.
CLI::Option* add_output(CLI::App& command, const std::string& name, std::string& file, const std::string& what);

}  // namespace forcebound::lab
