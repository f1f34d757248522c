#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// Options of what a command writes.
namespace forcebound::program {

/// --figure FILE.png, and --format of it. @param what "draw the ratios"
CLI::Option* add_figure(CLI::App& command, std::string& file, std::vector<std::string>& formats,
                        const std::string& what);
/// --figures FOLDER, and --format of them.
CLI::Option* add_figures(CLI::App& command, std::string& folder, std::vector<std::string>& formats,
                         const std::string& what);
/// An option of a file that is written, such as --json.
CLI::Option* add_output(CLI::App& command, const std::string& name, std::string& file, const std::string& what);

}  // namespace forcebound::program
