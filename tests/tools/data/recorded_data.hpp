#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace forcebound::test {

/// The source tree that this was built from, for the files of it that tests read.
const std::filesystem::path& source_folder();

/// A file of recorded data that tests use but that is not part of the project, or nothing where it is absent. It is
/// looked for in the folder named by FORCEBOUND_DATA, by default ../shared/data beside the source tree.
std::optional<std::filesystem::path> recorded_data(const std::string& file);

}  // namespace forcebound::test
