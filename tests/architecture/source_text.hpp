#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

/// What the rules read of a source file.
namespace forcebound::architecture {

/// A file's path as used in includes: without common/, client/ or server/. @param file relative to the source root
std::string_view include_path_of(std::string_view file);

/// Whether a file or folder lies somewhere below a folder.
bool is_below(std::string_view path, std::string_view folder);

/// Each line without its comment, numbered from 1.
void for_each_line(std::string_view text, const std::function<void(int number, const std::string& code)>& use);

/// What a line includes.
std::optional<std::string> included(const std::string& code);

}  // namespace forcebound::architecture
