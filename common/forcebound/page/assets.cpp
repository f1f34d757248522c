#include "forcebound/page/assets.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "forcebound/text/file.hpp"

namespace forcebound::page {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".woff2", "font/woff2"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".txt", "text/plain; charset=utf-8"},
}};

}  // namespace

std::string_view content_type(std::string_view name) noexcept {
  for (const auto& [ending, type] : kTypes) {
    if (name.ends_with(ending)) return type;
  }
  return {};
}

Assets read_assets(const fs::path& folder) {
  Assets assets;
  std::error_code none;
  if (!fs::is_directory(folder, none)) return assets;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_symlink() || !entry.is_regular_file()) continue;
    const std::string name = entry.path().lexically_relative(folder).generic_string();
    const std::string_view type = content_type(name);
    if (type.empty()) continue;
    if (assets.size() == kAssetsMost) {
      throw std::runtime_error(folder.string() + ": has more than " + std::to_string(kAssetsMost) +
                               " files for a page, which is the most that is served");
    }
    if (entry.file_size() > kAssetBytesMost) {
      throw std::runtime_error(entry.path().string() + ": is " + std::to_string(entry.file_size()) +
                               " bytes long, at most " + std::to_string(kAssetBytesMost) + " are served");
    }
    assets.emplace(name, Asset{std::string(type), text::read_file(entry.path().string(), kAssetBytesMost)});
  }
  return assets;
}

fs::path page_folder(const fs::path& program) {
  return program.parent_path().parent_path() / "share" / "forcebound" / "page";
}

}  // namespace forcebound::page
