#pragma once

#include <string>

#include "forcebound/control/law_registry.hpp"

namespace forcebound::law_plugin {

/// The laws that ship, and behind them those that this process has loaded. Any thread.
[[nodiscard]] control::LawRegistry known_laws();

/// The name by which `known_laws` has what is asked for: a law's name; NAME of forcebound-law-NAME.so in the folders of
/// FORCEBOUND_LAW_PATH or beside the programs, or the path of a law's library, with a '/' or ".so": these are loaded,
/// and stay. Any thread.
/// @throws std::invalid_argument in one line: the names that are known, or what is wrong with the library
[[nodiscard]] std::string law_named(const std::string& name_or_file);

/// Likewise for a program, on its main thread: where a law that it has loaded crashes, it ends with a line that names
/// the law (driver::catch_crashes).
[[nodiscard]] std::string law_of_option(const std::string& name_or_file);

}  // namespace forcebound::law_plugin
