#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace forcebound::text {

/// The parts between separators, of which those within quotes, brackets and braces are none.
[[nodiscard]] std::vector<std::string> split_outside_brackets(std::string_view text, char separator);

}  // namespace forcebound::text
