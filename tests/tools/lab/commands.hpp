#pragma once

namespace CLI {
class App;
}

/// Each experiment of forcebound-lab: one function, in a file of its own, that adds a subcommand to the program. What a
/// subcommand throws becomes one line on stderr: exit code 2 for std::invalid_argument, 4 for text::WriteError, 1 for
/// anything else.
namespace forcebound::lab {

void add_accuracy(CLI::App& app);
void add_bench(CLI::App& app);
void add_compare(CLI::App& app);
void add_fleet(CLI::App& app);
void add_identification(CLI::App& app);
void add_load(CLI::App& app);
void add_passivity(CLI::App& app);
void add_rates(CLI::App& app);
void add_rendering(CLI::App& app);
void add_reproduce(CLI::App& app);
void add_soak(CLI::App& app);
void add_teleoperate(CLI::App& app);
void add_violations(CLI::App& app);

}  // namespace forcebound::lab
