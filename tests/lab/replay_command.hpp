#pragma once

#include <CLI/App.hpp>

namespace forcebound::lab {

/// Adds `replay` and its options to a program. Parsing runs it and
/// @throws CLI::Error for options that are wrong, std::runtime_error for a file that is.
void add_replay(CLI::App& program);

}  // namespace forcebound::lab
