#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace forcebound::text {

/// The parts between separators; separators within quotes, brackets and braces do not count.
[[nodiscard]] std::vector<std::string> split_outside_brackets(std::string_view text, char separator);

}  // namespace forcebound::text
