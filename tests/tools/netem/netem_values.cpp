#include "tests/tools/netem/netem_values.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

namespace forcebound::netem {
namespace {

struct Unit {
  std::string_view name;  // lower case: units are read without regard to case
  double factor;
};

constexpr std::array<Unit, 13> kTimeUnits{{{"s", 1e9},
                                           {"sec", 1e9},
                                           {"secs", 1e9},
                                           {"ms", 1e6},
                                           {"msec", 1e6},
                                           {"msecs", 1e6},
                                           {"us", 1e3},
                                           {"usec", 1e3},
                                           {"usecs", 1e3},
                                           {"ns", 1},
                                           {"nsec", 1},
                                           {"nsecs", 1},
                                           {"", 1e3}}};

constexpr std::array<Unit, 19> kRateUnits{{{"", 1},
                                           {"bit", 1},
                                           {"kbit", 1e3},
                                           {"mbit", 1e6},
                                           {"gbit", 1e9},
                                           {"tbit", 1e12},
                                           {"kibit", 0x1p10},
                                           {"mibit", 0x1p20},
                                           {"gibit", 0x1p30},
                                           {"tibit", 0x1p40},
                                           {"bps", 8},
                                           {"kbps", 8e3},
                                           {"mbps", 8e6},
                                           {"gbps", 8e9},
                                           {"tbps", 8e12},
                                           {"kibps", 8 * 0x1p10},
                                           {"mibps", 8 * 0x1p20},
                                           {"gibps", 8 * 0x1p30},
                                           {"tibps", 8 * 0x1p40}}};

constexpr double kLongestTime_ns = 86400e9;
constexpr double kHighestRate = 1e15;

[[noreturn]] void refuse(std::string_view text, std::string_view meaning, std::string_view accepted) {
  throw std::invalid_argument("'" + std::string(text) + "' is not a valid " + std::string(meaning) + ": expected " +
                              std::string(accepted));
}

struct Number {
  double value;
  std::string_view rest;
  bool read;
};

// Not strtod: it depends on the locale, and accepts "inf" and hexadecimal.
Number leading_number(std::string_view text) {
  Number number{0, text, false};
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), number.value, std::chars_format::general);
  number.read = error == std::errc{} && std::isfinite(number.value);
  if (number.read) number.rest.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

const Unit* find_unit(std::span<const Unit> units, std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const auto found = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == lower; });
  return found == units.end() ? nullptr : &*found;
}

}  // namespace

time::Nanoseconds parse_time(std::string_view text, std::string_view meaning) {
  constexpr std::string_view kAccepted =
      "a time from 0 to 86400s such as 50ms, 1.5s, 200us or 10ns (without a unit: microseconds)";
  const auto [value, rest, read] = leading_number(text);
  const Unit* unit = find_unit(kTimeUnits, rest);
  if (!read || unit == nullptr) refuse(text, meaning, kAccepted);
  const double ns = value * unit->factor;
  if (ns < 0 || ns > kLongestTime_ns) refuse(text, meaning, kAccepted);
  return time::Nanoseconds{std::llround(ns)};
}

Share parse_percent(std::string_view text, std::string_view meaning) {
  const auto [value, rest, read] = leading_number(text);
  if (!read || (!rest.empty() && rest != "%") || value < 0 || value > 100)
    refuse(text, meaning, "a percentage from 0% to 100%");
  return static_cast<Share>(std::llround(value / 100 * kCertain));
}

std::uint64_t parse_rate(std::string_view text, std::string_view meaning) {
  constexpr std::string_view kAccepted =
      "a rate above 0 such as 1Mbit, 64kbit or 100kbps (bit: bits, bps: bytes per second; without a unit: bits)";
  const auto [value, rest, read] = leading_number(text);
  const Unit* unit = find_unit(kRateUnits, rest);
  if (!read || unit == nullptr) refuse(text, meaning, kAccepted);
  const double bits_per_second = std::round(value * unit->factor);
  if (bits_per_second < 1 || bits_per_second > kHighestRate) refuse(text, meaning, kAccepted);
  return static_cast<std::uint64_t>(bits_per_second);
}

std::int64_t parse_integer(std::string_view text, std::string_view meaning, std::int64_t lowest, std::int64_t highest) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stopped != end || value < lowest || value > highest)
    refuse(text, meaning, "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  return value;
}

bool is_unit(std::string_view text) noexcept {
  return text == "%" || find_unit(kTimeUnits, text) != nullptr || find_unit(kRateUnits, text) != nullptr;
}

bool looks_like_number(std::string_view text) noexcept {
  return !text.empty() && ((text[0] >= '0' && text[0] <= '9') || text[0] == '-' || text[0] == '+' || text[0] == '.');
}

}  // namespace forcebound::netem
