#pragma once

#include <optional>
#include <string>
#include <string_view>

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

}  // namespace forcebound::text
