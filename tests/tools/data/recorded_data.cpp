#include "tests/tools/data/recorded_data.hpp"

#include <cstdlib>

namespace forcebound::test {

const std::filesystem::path& source_folder() {
  static const std::filesystem::path folder = FORCEBOUND_SOURCE_DIR;
  return folder;
}

std::optional<std::filesystem::path> recorded_data(const std::string& file) {
  const char* folder = std::getenv("FORCEBOUND_DATA");
  const std::filesystem::path root =
      folder != nullptr && *folder != '\0' ? std::filesystem::path(folder) : source_folder() / "../shared/data";
  const auto path = root / file;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace forcebound::test
