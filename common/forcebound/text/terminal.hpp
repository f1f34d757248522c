#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace forcebound::text {

/// Programs' output fits this many columns.
inline constexpr std::size_t kColumns = 80;

enum class Colour : std::uint8_t { none, ansi };

/// ansi for a terminal, unless NO_COLOR is set to anything or TERM is "dumb" (https://no-color.org).
[[nodiscard]] Colour colour_for(int descriptor) noexcept;

/// The text in red, if `colour` allows it.
[[nodiscard]] std::string red(std::string_view text, Colour colour);

/// The columns of UTF-8 text on a terminal, if each character takes one.
[[nodiscard]] std::size_t columns_of(std::string_view text) noexcept;

/// Breaks lines that are longer than `columns` at blanks, or after commas where a single word is that long;
/// continuation lines are indented by `indent`. A word that cannot be broken stays whole. Shorter lines stay as they
/// are.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t indent, std::size_t columns = kColumns);

/// The same for lines of a name and its description, which two blanks or more separate: they continue below the
/// description. Other lines continue `more` columns to the right of their start.
[[nodiscard]] std::string wrapped_below_descriptions(std::string_view text, std::size_t more,
                                                     std::size_t columns = kColumns);

/// The same for a program's --help, whose paragraphs continue at their start.
[[nodiscard]] std::string wrapped_help(std::string_view help, std::size_t columns = kColumns);

/// "1 tick", "2 ticks". @param many the plural; empty: the singular with an s
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view one, std::string_view many = {});

}  // namespace forcebound::text
