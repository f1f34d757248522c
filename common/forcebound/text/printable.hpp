#pragma once

#include <span>
#include <string>
#include <string_view>

namespace forcebound::text {

/// Makes UTF-8 text of an untrusted client, file or recording harmless on a terminal and in a log line: each byte of a
/// control character, line endings included, becomes '?', as does a byte that begins a control sequence on terminals
/// that are not set to UTF-8.
///
/// All that programs print and did not write themselves goes through here.
///
/// Real time: no allocation.
void make_printable(std::span<char> text) noexcept;

/// A printable copy.
[[nodiscard]] std::string printable(std::string_view text);

/// The same for text of several lines, which keeps its line feeds.
[[nodiscard]] std::string printable_lines(std::string_view text);

}  // namespace forcebound::text
