#pragma once

#include <string>
#include <string_view>

namespace forcebound::text {

/// The whole of a text file.
/// @throws std::runtime_error `PATH: cannot be read: REASON`.
[[nodiscard]] std::string read_file(const std::string& path);

/// Replaces the file's content, byte for byte, by way of a new file beside it: it is the old one or the new one, even
/// if the disk is full or the program is killed. A device, a pipe, a link, or a file in a folder that takes no new
/// ones, is written in place.
/// @throws std::runtime_error `PATH: cannot be written: REASON`.
void write_file(const std::string& path, std::string_view content);

/// Whether write_file can write there, for before long work. Leaves everything as it is. That a disk will be full, it
/// cannot know.
/// @throws std::runtime_error `PATH: cannot be written: REASON`.
void expect_writable(const std::string& path);

}  // namespace forcebound::text
