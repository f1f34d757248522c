#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace forcebound::text {

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string to_text(double value);

/// Three significant digits, or `digits`, with an exponent only for very large and very small numbers. Infinite:
/// "inf".
[[nodiscard]] std::string rounded(double value, int digits = 3);

/// So many digits behind the point, and no sign before what is then zero. Not finite: "-".
[[nodiscard]] std::string fixed(double value, int decimals);

/// The whole text as a finite number, in any notation with a decimal point, whatever the locale. Nothing if it is
/// anything else.
[[nodiscard]] std::optional<double> finite_number(std::string_view text) noexcept;

/// The whole text as a whole number of this type, in decimal digits. Nothing if it is anything else.
template <std::integral Whole>
[[nodiscard]] std::optional<Whole> whole_number(std::string_view text) noexcept {
  Whole value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped != end) return std::nullopt;
  return value;
}

}  // namespace forcebound::text
