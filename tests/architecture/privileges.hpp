#pragma once

#include <string_view>
#include <vector>

#include "tests/architecture/violation.hpp"

/// What only some files may have: libraries of others, threads, sockets, the clock, randomness, the process's locale.
namespace forcebound::architecture {

/// All of it in one source file that may not have it. @param file path relative to the source root, with '/'
std::vector<Violation> privilege_violations(std::string_view file, std::string_view text);

}  // namespace forcebound::architecture
