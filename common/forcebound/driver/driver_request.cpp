#include "forcebound/driver/driver_request.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/text/printable.hpp"

namespace forcebound::driver {

DriverRequest DriverRequest::parse(std::string_view text) {
  const std::size_t colon = text.find(':');
  DriverRequest request{.name = std::string(text.substr(0, colon))};
  std::string_view rest = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
    const std::size_t equals = item.find('=');
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument("device '" + text::printable(request.name) + "': " + why);
    };
    if (equals == std::string_view::npos || equals == 0) {
      refuse("expected KEY=VALUE, got '" + text::printable(item) + "'");
    }
    std::string key(item.substr(0, equals));
    std::string value(item.substr(equals + 1));
    const bool twice = std::ranges::any_of(request.settings, [&](const auto& other) { return other.first == key; });
    if (twice || (key == "facts" && !request.facts_file.empty())) refuse(key + " is given twice");
    if (key != "facts") {
      request.settings.emplace_back(std::move(key), std::move(value));
    } else if (value.empty()) {
      refuse("facts must be the path of a .toml file");
    } else {
      request.facts_file = std::move(value);
    }
  }
  return request;
}

}  // namespace forcebound::driver
