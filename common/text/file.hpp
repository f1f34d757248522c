#pragma once

#include <string>

namespace forcebound::text {

/// The whole of a text file.
/// @throws std::runtime_error `PATH: cannot be read: REASON`.
[[nodiscard]] std::string read_file(const std::string& path);

}  // namespace forcebound::text
