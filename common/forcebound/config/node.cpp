#include "forcebound/config/node.hpp"

#include <sstream>

#include "forcebound/config/config_error.hpp"
#include "forcebound/text/numbers.hpp"

// The one file that knows the TOML library: it takes seconds to compile.
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

namespace forcebound::config {
namespace {

Node converted(const toml::node& node) {
  Node made{.line = static_cast<int>(node.source().begin.line)};
  if (const toml::table* const table = node.as_table()) {
    Node::Table& all = made.value.emplace<Node::Table>();
    for (const auto& [key, value] : *table) all.emplace(key.str(), converted(value));
  } else if (const toml::array* const list = node.as_array()) {
    Node::List& all = made.value.emplace<Node::List>();
    all.reserve(list->size());
    for (const toml::node& value : *list) all.push_back(converted(value));
  } else if (const auto* const word = node.as_string()) {
    made.value = word->get();
  } else if (const auto* const number = node.as_floating_point()) {
    made.value = number->get();
  } else if (const auto* const whole = node.as_integer()) {
    made.value = whole->get();
  } else if (const auto* const flag = node.as_boolean()) {
    made.value = flag->get();
  } else {
    std::ostringstream text;
    node.visit([&text](const auto& time) { text << time; });
    made.value = Node::Time{text.str()};
  }
  return made;
}

std::string as_text(const std::string& text) {
  if (text.find_first_of("'\n\r\t") == std::string::npos) return "'" + text + "'";
  std::ostringstream quoted;
  quoted << toml::value<std::string>(text);
  return quoted.str();
}

std::string as_text(double number) { return text::to_text(number); }
std::string as_text(std::int64_t number) { return std::to_string(number); }
std::string as_text(bool flag) { return flag ? "true" : "false"; }
std::string as_text(const Node::Time& time) { return time.text; }

std::string as_text(const Node::List& list) {
  std::string text;
  for (const Node& node : list) text += (text.empty() ? "" : ", ") + written(node);
  return "[" + text + "]";
}

std::string as_text(const Node::Table& table) {
  std::string text;
  for (const auto& [key, node] : table) text += (text.empty() ? "" : ", ") + key + " = " + written(node);
  return "{" + text + "}";
}

}  // namespace

const Node* Node::find(std::string_view key) const noexcept {
  const Table* const table = as<Table>();
  if (table == nullptr) return nullptr;
  const auto found = table->find(key);
  return found == table->end() ? nullptr : &found->second;
}

std::string Node::text_at(std::string_view key) const {
  const Node* const node = find(key);
  const std::string* const text = node == nullptr ? nullptr : node->as<std::string>();
  return text == nullptr ? std::string() : *text;
}

std::string written(const Node& node) {
  return std::visit([](const auto& value) { return as_text(value); }, node.value);
}

Node parse_toml(std::string_view text, const std::string& place) {
  try {
    return converted(toml::parse(text, place));
  } catch (const toml::parse_error& error) {
    throw ConfigError(place + ":" + std::to_string(error.source().begin.line) +
                      ": not TOML: " + std::string(error.description()));
  }
}

Node parse_toml_value(std::string_view text, int line) {
  try {
    const toml::table wrapped =
        toml::parse(std::string(static_cast<std::size_t>(line) - 1, '\n') + "value = " + std::string(text));
    // More than one key: the value had lines of its own.
    if (wrapped.size() == 1) return converted(wrapped.begin()->second);
  } catch (const toml::parse_error&) {
  }
  throw ConfigError("must be a value as TOML writes it, got '" + std::string(text) + "'");
}

}  // namespace forcebound::config
