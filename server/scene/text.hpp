#pragma once

#include <span>
#include <string>
#include <string_view>

namespace forcebound::server {

/// The shortest text that reads back as the same number.
std::string to_text(double value);

/// "a, b, c".
std::string join(std::span<const std::string> names);

/// ", did you mean 'sphere'?", or nothing where no name is near.
std::string suggestion(std::string_view wrong, std::span<const std::string> known);

}  // namespace forcebound::server
