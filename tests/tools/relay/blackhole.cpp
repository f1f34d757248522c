#include "tests/tools/relay/blackhole.hpp"

#include <charconv>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace forcebound::relay {
namespace {

constexpr double kMost_s = 1e6;

std::optional<time::Nanoseconds> parse_time(std::string_view text) {
  double seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds, std::chars_format::fixed);
  const bool number = error == std::errc{} && end == text.data() + text.size();
  if (!number || !(seconds >= 0 && seconds <= kMost_s)) return std::nullopt;
  return time::from_seconds(seconds);
}

}  // namespace

BlackholeOption parse_blackhole(const std::string& text) {
  const std::string_view all = text;
  const std::size_t colon = all.find(':');
  const std::size_t dash = all.find('-');
  if (colon != std::string_view::npos && dash != std::string_view::npos && colon < dash) {
    const std::string_view way = all.substr(0, colon);
    const auto from = parse_time(all.substr(colon + 1, dash - colon - 1));
    const auto to = parse_time(all.substr(dash + 1));
    const bool up = way == "up" || way == "both";
    const bool down = way == "down" || way == "both";
    if ((up || down) && from && to && *from < *to) return {up, down, {*from, *to}};
  }
  throw std::invalid_argument("'" + text +
                              "' is not a blackhole: expected up, down or both, and seconds since the start, as in "
                              "up:5-65");
}

}  // namespace forcebound::relay
