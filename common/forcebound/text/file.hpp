#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace forcebound::text {

/// The whole of a text file.
/// @throws std::runtime_error `PATH: cannot be read: REASON`, also for more than 256 MiB from a device or a pipe.
[[nodiscard]] std::string read_file(const std::string& path);

/// Replaces the file's content, byte for byte, by way of a new file beside it, PATH.new-PID: it is the old one or the
/// new one, even if the disk is full or the program is killed. Written in place is what a new file cannot replace: a
/// device, a pipe, a link, a file that has several names, another owner or group, or its own mount, and one in a folder
/// that takes no new ones, or whose name is too long for the ending.
/// @throws std::runtime_error `PATH: cannot be written: REASON`.
void write_file(const std::string& path, std::string_view content);

/// Whether write_file can write there, for before long work. Leaves everything as it is. That a disk will be full, it
/// cannot know.
/// @throws std::runtime_error `PATH: cannot be written: REASON`.
void expect_writable(const std::string& path);

/// Whether something other than a regular file is there, such as a device or a pipe: writing to it replaces nothing.
[[nodiscard]] bool is_special_file(const std::filesystem::path& path);

/// Whether both name one file, there or not yet: by links, by several names, or by other ways to its folder.
[[nodiscard]] bool is_same_path(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace forcebound::text
