#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <system_error>

namespace forcebound::page {

/// Digits of a value on a page: what a chart or picture shows, and no more bytes.
inline constexpr int kShownDigits = 6;

/// Adds a number in JSON; null where it is not finite.
inline void add_number(std::string& to, double value, int digits = kShownDigits) {
  constexpr std::size_t kLongest = 32;
  std::array<char, kLongest> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  if (!std::isfinite(value) || error != std::errc{}) {
    to += "null";
  } else {
    to.append(text.data(), end);
  }
}

/// Adds a list of numbers in JSON.
template <class Number>
void add_numbers(std::string& to, std::span<const Number> values) {
  to += '[';
  for (const Number& value : values) {
    if (&value != values.data()) to += ',';
    add_number(to, static_cast<double>(value));
  }
  to += ']';
}

}  // namespace forcebound::page
