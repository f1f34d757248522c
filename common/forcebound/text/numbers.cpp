#include "forcebound/text/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace forcebound::text {

std::string to_text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string rounded(double value, int digits) {
  std::array<char, 32> buffer{};
  const auto print = [&](double number, std::chars_format format) {
    return std::string(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, format).ptr);
  };
  const auto short_end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, digits).ptr;
  double rounded_value = value;
  std::from_chars(buffer.data(), short_end, rounded_value);
  const double size = std::abs(rounded_value);
  const bool written_out = size == 0 || (size >= 1e-3 && size < 1e7);
  return print(rounded_value, written_out ? std::chars_format::fixed : std::chars_format::general);
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  // The longest number has 309 digits before its point.
  std::array<char, 400> buffer{};
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, decimals).ptr;
  const std::string_view text(buffer.data(), end);
  const bool zero = text.find_first_of("123456789") == std::string_view::npos;
  return std::string(zero && text.starts_with('-') ? text.substr(1) : text);
}

std::optional<double> finite_number(std::string_view text) noexcept {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace forcebound::text
