#pragma once

#include <span>
#include <string>
#include <string_view>

namespace forcebound::text {

/// Makes an untrusted client's UTF-8 text harmless on a terminal and in a log line: each byte of a control character,
/// line endings included, becomes '?'.
///
/// Real time: no allocation.
void make_printable(std::span<char> text) noexcept;

/// A printable copy.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace forcebound::text
