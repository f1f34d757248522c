#include "forcebound/client/ros2/topic_names.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::ros2 {
namespace {

// A participant's ports are at 7400 + 250 domain: further domains have none.
constexpr unsigned kDomainMost = 232;

constexpr std::string_view kPrefix = "rt";  // of topics, before the namespace

std::string shown(std::string_view name) {
  constexpr std::size_t kMost = 120;
  return text::printable(name.substr(0, kMost));
}

bool is_token(std::string_view token) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto fits = [&](char c) { return c == '_' || is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !token.empty() && !is_digit(token.front()) && token.find("__") == std::string_view::npos &&
         std::ranges::all_of(token, fits);
}

unsigned domain(std::string_view source, std::string_view text) {
  const auto number = text::whole_number<unsigned>(text);
  if (number && *number <= kDomainMost) return *number;
  throw std::invalid_argument(std::string(source) + " must be a whole number from 0 to " + std::to_string(kDomainMost) +
                              ", got '" + std::string(text) + "'");
}

}  // namespace

std::string checked_namespace(std::string_view name_space) {
  if (name_space.empty() || name_space == "/") return {};
  std::string_view rest = name_space;
  if (rest.front() == '/') rest.remove_prefix(1);
  const std::string checked = "/" + std::string(rest);
  for (bool more = true; more;) {
    const std::size_t end = std::min(rest.find('/'), rest.size());
    if (!is_token(rest.substr(0, end))) {
      throw std::invalid_argument(
          "a namespace has letters, digits and single underscores between its slashes, and no "
          "digit first, as /left/pen; got '" +
          std::string(name_space) + "'");
    }
    more = end < rest.size();
    if (more) rest.remove_prefix(end + 1);
  }
  return checked;
}

std::string dds_topic(std::string_view name_space, std::string_view name) {
  return std::string(kPrefix) + std::string(name_space) + "/" + std::string(name);
}

std::string ros_topic(std::string_view topic_of_dds) {
  if (topic_of_dds.starts_with(kPrefix)) topic_of_dds.remove_prefix(kPrefix.size());
  return shown(topic_of_dds);
}

std::string ros_type(std::string_view type_of_dds) {
  constexpr std::string_view kFolders = "::msg::dds_::";
  const std::size_t at = type_of_dds.find(kFolders);
  if (at == std::string_view::npos || !type_of_dds.ends_with('_')) return shown(type_of_dds);
  const std::string_view name = type_of_dds.substr(at + kFolders.size());
  return shown(std::string(type_of_dds.substr(0, at)) + "/msg/" + std::string(name.substr(0, name.size() - 1)));
}

unsigned domain_of(std::string_view given, const char* environment) {
  if (!given.empty()) return domain("--domain", given);
  if (environment == nullptr || *environment == '\0') return 0;
  return domain("ROS_DOMAIN_ID", environment);
}

}  // namespace forcebound::ros2
