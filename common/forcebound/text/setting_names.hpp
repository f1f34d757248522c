#pragma once

#include <string>
#include <string_view>

namespace forcebound::text {

/// A text that names options, for a program of Python or C, where the same are settings: "--server-key" gets
/// 'server_key', and "--psk", which is a word of command lines, 'shared_key'.
[[nodiscard]] std::string with_setting_names(std::string_view text);

}  // namespace forcebound::text
