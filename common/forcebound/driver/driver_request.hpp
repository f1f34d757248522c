#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace forcebound::driver {

/// `NAME[:KEY=VALUE,...]` of a command line.
struct DriverRequest {
  std::string name;
  std::vector<std::pair<std::string, std::string>> settings{};
  std::string facts_file{};  ///< of the key `facts`, which no driver sees

  /// @throws std::invalid_argument in one line
  [[nodiscard]] static DriverRequest parse(std::string_view text);
};

}  // namespace forcebound::driver
