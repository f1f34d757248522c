#include "tests/tools/data/recorded_data.hpp"

#include <cstdlib>

namespace forcebound {

std::optional<std::filesystem::path> recorded_data(const std::string& file) {
  const char* folder = std::getenv("FORCEBOUND_DATA");
  const std::filesystem::path root = folder != nullptr && *folder != '\0' ? folder : "../shared/data";
  const auto path = root / file;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

}  // namespace forcebound
