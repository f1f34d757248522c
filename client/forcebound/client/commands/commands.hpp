#pragma once

namespace CLI {
class App;
}

/// Each command of `forcebound`: one function, in a file or folder of its own, that adds it to the program. What a
/// command throws becomes one line on stderr: exit code 2 for std::invalid_argument, 4 for text::WriteError, 1 for
/// anything else.
namespace forcebound::client::commands {

void add_check_device(CLI::App& app);
void add_doctor(CLI::App& app);
void add_identify(CLI::App& app);
void add_keygen(CLI::App& app);
void add_replay(CLI::App& app);
void add_report(CLI::App& app);
void add_table(CLI::App& app);
void add_view(CLI::App& app);

}  // namespace forcebound::client::commands
