#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace forcebound::test {

/// A file of recorded data that tests use but that is not part of the project, or nothing where it is absent. It is
/// looked for in the folder named by FORCEBOUND_DATA, by default ../shared/data beside the source tree.
inline std::optional<std::filesystem::path> recorded_data(const std::string& file) {
  const char* folder = std::getenv("FORCEBOUND_DATA");
  const std::filesystem::path root = folder != nullptr && *folder != '\0'
                                         ? std::filesystem::path(folder)
                                         : std::filesystem::path(FORCEBOUND_SOURCE_DIR) / "../shared/data";
  const auto path = root / file;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace forcebound::test
