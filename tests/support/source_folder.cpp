#include "tests/support/source_folder.hpp"

namespace forcebound::test {

const std::filesystem::path& source_folder() {
  static const std::filesystem::path kFolder = FORCEBOUND_SOURCE_DIR;
  return kFolder;
}

}  // namespace forcebound::test
