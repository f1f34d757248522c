#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace forcebound::program {

/// Gives a program --config FILE.toml: a file with its options, by their names without the dashes.
///
///     listen = "0.0.0.0:47800"
///     scenes = ["wall", "sphere"]   # what may be given more than once
///     realtime = true               # an option without a value
///
/// An option on the command line replaces that of the file. Names of files mean the same as on the command line.
void add_option_file(CLI::App& app);

/// The words of the command line, the program's name left out, with those of its --config behind them. Without --config
/// they are as given. @throws std::invalid_argument for an unknown key or a value of the wrong type, with file and
/// line; std::runtime_error if the file cannot be read.
[[nodiscard]] std::vector<std::string> with_option_file(const CLI::App& app, int argc, const char* const* argv);

}  // namespace forcebound::program
