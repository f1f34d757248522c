#pragma once

#include <map>
#include <string>
#include <vector>

namespace forcebound::architecture {

/// Files that include each other in a circle. A header and the source of its name, which may lie in `internal` of the
/// same folder, count as one file.
///
/// @param texts by path relative to the source root, with '/'
/// @returns a text for each circle: where each of its includes stands
std::vector<std::string> file_circles(const std::map<std::string, std::string>& texts);

}  // namespace forcebound::architecture
