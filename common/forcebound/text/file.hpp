#pragma once

#include <string>
#include <string_view>

namespace forcebound::text {

/// The whole of a text file.
/// @throws std::runtime_error `PATH: cannot be read: REASON`.
[[nodiscard]] std::string read_file(const std::string& path);

/// Replaces the file's content, byte for byte.
/// @throws std::runtime_error `PATH: cannot be written: REASON`.
void write_file(const std::string& path, std::string_view content);

}  // namespace forcebound::text
