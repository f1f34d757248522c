#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace forcebound::page {

/// A file of the page, as it is sent.
struct Asset {
  std::string type;  ///< its Content-Type
  std::string content;
};

/// The files of a page by their names in addresses: "index.html", "licences/three.txt". They are read once, so that no
/// request ever names a path.
using Assets = std::map<std::string, Asset, std::less<>>;

inline constexpr std::size_t kAssetsMost = 64;
inline constexpr std::size_t kAssetBytesMost = std::size_t{8} << 20U;

/// Reads all files of a folder and of those below it whose type is known by their extension: html, js, css, svg, png,
/// woff2, json, txt. Links are not followed. A folder that is not there has no files.
/// @throws std::runtime_error naming a file that cannot be read or is larger than 8 MiB, or if there are more than 64
[[nodiscard]] Assets read_assets(const std::filesystem::path& folder);

/// The Content-Type of a file's name; empty: not served.
[[nodiscard]] std::string_view content_type(std::string_view name) noexcept;

/// The folder of the page that belongs to a program: ../share/forcebound/page beside the folder of its file, in the
/// build tree as where it is installed.
/// @param program its path
[[nodiscard]] std::filesystem::path page_folder(const std::filesystem::path& program);

}  // namespace forcebound::page
