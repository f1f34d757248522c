#pragma once

#include <string>

namespace forcebound::client {

/// The whole of a text file.
/// @throws std::runtime_error `PATH: cannot be read: REASON`.
[[nodiscard]] std::string read_text_file(const std::string& path);

}  // namespace forcebound::client
