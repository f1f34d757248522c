#pragma once

#include <filesystem>
#include <string>

/// Shared by the files of this folder that read and write files.
namespace forcebound::text {

/// @throws std::runtime_error always: `PATH: cannot be read: REASON`
[[noreturn]] void refuse_reading(const std::string& path, const std::string& why);

/// `PATH: cannot be written: REASON`
[[nodiscard]] std::string not_writable(const std::string& path, const std::string& why);

/// @throws std::runtime_error always, with that
[[noreturn]] void refuse_writing(const std::string& path, const std::string& why);

/// The file that a link, or a chain of them, leads to; there or not yet.
[[nodiscard]] std::filesystem::path end_of_links(std::filesystem::path path);

}  // namespace forcebound::text
