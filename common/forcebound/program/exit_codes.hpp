#pragma once

#include <initializer_list>
#include <string>

namespace forcebound::program {

/// The last line of --help, of a program that never ends with some exit codes: kExitCodes without these.
[[nodiscard]] std::string exit_codes_without(std::initializer_list<int> never);

}  // namespace forcebound::program
