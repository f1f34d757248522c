#include "forcebound/text/setting_names.hpp"

#include <algorithm>

namespace forcebound::text {

std::string with_setting_names(std::string_view text) {
  constexpr std::string_view kDashes = "--";
  std::string named;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t dashes = std::min(text.find(kDashes, at), text.size());
    named += text.substr(at, dashes - at);
    const std::string_view rest = text.substr(std::min(dashes + kDashes.size(), text.size()));
    std::string name(rest.substr(0, rest.find_first_not_of("abcdefghijklmnopqrstuvwxyz-")));
    while (name.ends_with('-')) name.pop_back();
    at = dashes + kDashes.size() + name.size();
    std::ranges::replace(name, '-', '_');
    if (name == "psk") name = "shared_key";
    if (name.empty()) {
      named += text.substr(dashes, kDashes.size());
    } else {
      named += "'" + name + "'";
    }
  }
  return named;
}

}  // namespace forcebound::text
