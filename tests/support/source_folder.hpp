#pragma once

#include <filesystem>

namespace forcebound::test {

/// The source tree that this was built from, for the files of it that tests read.
const std::filesystem::path& source_folder();

}  // namespace forcebound::test
