#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "forcebound/time/clock.hpp"
#include "tests/tools/netem/random.hpp"

/// The values in netem's words: times, percentages and rates in tc's syntax. Each names the word it was read for in its
/// error, as @throws std::invalid_argument.
namespace forcebound::netem {

/// "50ms", "1.5s", "200us", "10ns"; "50" is 50 microseconds. At most a day.
time::Nanoseconds parse_time(std::string_view text, std::string_view meaning);

/// "5%" or "5", from 0 to 100.
Share parse_percent(std::string_view text, std::string_view meaning);

/// "1Mbit", "64kbit", "100kbps" (bytes), "1Mibit"; "8000" is bits per second. In bits per second, more than 0.
std::uint64_t parse_rate(std::string_view text, std::string_view meaning);

/// Whole numbers between the two bounds.
std::int64_t parse_integer(std::string_view text, std::string_view meaning, std::int64_t lowest,
                           std::int64_t highest = std::numeric_limits<std::uint32_t>::max());

/// The words that parse_netem reads, with the units that it took them for: "delay 50us 10us" for "delay 50 10".
/// @throws std::invalid_argument as parse_netem
std::string with_units(std::string_view words);

/// Whether this is a unit, without its number.
bool is_unit(std::string_view text) noexcept;

/// Whether an optional number follows: netem decides by the first character.
bool looks_like_number(std::string_view text) noexcept;

}  // namespace forcebound::netem
