#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/program/option_checks.hpp"

// Reading <CLI/CLI.hpp> takes longer than all that most sources do: it is left to those that add options.
namespace CLI {
class App;
}

/// What the command lines of all programs have in common: the look of --help, the wording of errors, and exit codes.
namespace forcebound::program {

/// Exit codes. Wrong use: an option is unknown, lacks its value, has one that can never be right, or does not go with
/// another. Failed: the command line is right, but a file, host or device cannot be used, or a run lost its session and
/// was refused another. Not passive: the run ended, and its summary says NOT PASSIVE. Output lost: it ended well, but
/// of what it was to write (a file, standard output) something is missing. Never connected: it had no session,
/// whatever ended it. The first of not passive, failed, output lost and never connected that holds is returned.
/// Driver crashed: of a device or a robot; it was stopped, and nothing of what comes at the end was written.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kWrongUse = 2;
inline constexpr int kNotPassive = 3;
inline constexpr int kOutputLost = 4;
inline constexpr int kNeverConnected = 5;
inline constexpr int kDriverCrashed = 6;

/// The last line of --help, of a program that ends with all of them; see exit_codes.hpp for others.
inline constexpr std::string_view kExitCodes =
    "Exit code: 0 done, 1 failed, 2 wrong use, 3 NOT PASSIVE, 4 output lost, 5 never connected, 6 driver crashed.";

/// The program ends after its command line: help, version or wrong use.
struct End {
  int exit_code = kDone;
  std::string text;  ///< for stdout if the exit code is 0, else one line for stderr
};

/// Gives a program its name, --help, --version and the look of its help, 80 columns wide. Paragraphs of descriptions
/// and footers are written as one line each. To be called before subcommands are added, which have the same look.
void set_up(CLI::App& app, const std::string& name);

/// Reads the command line, and runs the subcommand's callback if there is one.
/// @throws End for --help, --version and wrong use, which a callback reports as std::invalid_argument.
/// @throws std::exception what a callback throws otherwise.
void parse(CLI::App& app, int argc, const char* const* argv);

/// Runs a program: prints what ends it on stderr, in one line unless it has line feeds, without control characters.
/// @returns its exit code: that of an End, kWrongUse for std::invalid_argument, kOutputLost for text::WriteError,
/// kFailed for any other exception; where standard output is lost, kOutputLost for kDone and kNeverConnected.
int run(const std::string& name, const std::function<int()>& work) noexcept;

/// The value that `read` returns; the message of a std::invalid_argument gets the option's name in front.
template <typename Read>
auto value_of(std::string_view option, Read&& read) {
  try {
    return read();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(option) + ": " + error.what());
  }
}

/// An option that names a file, such as {"--record", "run.mcap"}; no file if the name is empty.
struct FileOption {
  std::string_view option;
  std::string file;
};

/// To be called before long work. Devices and pipes may be written twice, and read as well.
/// @throws std::invalid_argument if writing `output` would replace one of the others.
void expect_apart(const FileOption& output, const std::vector<FileOption>& others);

}  // namespace forcebound::program
