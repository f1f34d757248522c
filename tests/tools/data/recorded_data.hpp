#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace forcebound {

/// A file of recorded data that is used but that is not part of the project, or nothing where it is absent. It is
/// looked for in the folder named by FORCEBOUND_DATA, by default ../shared/data from the working directory.
std::optional<std::filesystem::path> recorded_data(const std::string& file);

}  // namespace forcebound
