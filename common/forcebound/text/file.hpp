#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace forcebound::text {

/// The largest file that `read_file` takes unless its caller says less.
inline constexpr std::size_t kFileBytesMost = std::size_t{256} << 20U;

/// The whole of a regular file. What is none, such as a device or a pipe, may be without end or never answer: it is not
/// even waited for. Neither is more than `bytes_most` read.
/// @throws std::runtime_error `PATH: cannot be read: REASON`.
[[nodiscard]] std::string read_file(const std::string& path, std::size_t bytes_most = kFileBytesMost);

/// What was to be written is lost, or part of it.
class WriteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Replaces the file's content, byte for byte, by way of a new file beside it, PATH.new-PID: it is the old one or the
/// new one, even if the disk is full or the program is killed. Written in place is what a new file cannot replace: a
/// device, a pipe, a link, a file that has several names, another owner or group, or its own mount, and one in a folder
/// that takes no new ones, or whose name is too long for the ending.
/// @throws WriteError `PATH: cannot be written: REASON`.
void write_file(const std::string& path, std::string_view content);

/// Whether write_file can write there, for before long work. Leaves everything as it is. That a disk will be full, it
/// cannot know.
/// @throws std::runtime_error `PATH: cannot be written: REASON`.
void expect_writable(const std::string& path);

/// Whether something other than a regular file is there, such as a device or a pipe: writing to it replaces nothing.
[[nodiscard]] bool is_special_file(const std::filesystem::path& path);

/// The path of a file that another file names, so that none names what its author does not own.
/// @param named by that file; relative: from `folder`
/// @param folder of that file; empty: the working directory
/// @param others further folders in which it may lie
/// @throws std::runtime_error unless it lies in one of them, or below, also where links lead; says what is allowed.
[[nodiscard]] std::string path_within(const std::string& named, const std::string& folder,
                                      std::span<const std::string> others = {});

/// Whether both name one file, there or not yet: by links, by several names, or by other ways to its folder.
[[nodiscard]] bool is_same_path(const std::filesystem::path& one, const std::filesystem::path& other);

/// The file that this process runs; empty: not known.
[[nodiscard]] std::filesystem::path program_path();

}  // namespace forcebound::text
