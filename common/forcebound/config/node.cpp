#include "forcebound/config/node.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "forcebound/config/config_error.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

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
    control::ClassicText text;
    node.visit([&text](const auto& time) { text << time; });
    made.value = Node::Time{text.str()};
  }
  return made;
}

/// The position after the string that begins at `begin`; an unfinished one ends with its line.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const std::string three(3, quote);
  const bool has_lines = text.substr(begin, 3) == three;
  for (std::size_t i = begin + (has_lines ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (has_lines && text.substr(i, 3) == three) {
      // Two quotes before the final three belong to the string.
      return std::min({text.find_first_not_of(quote, i), i + 5, text.size()});
    } else if (!has_lines && (text[i] == quote || text[i] == '\n')) {
      return text[i] == quote ? i + 1 : i;
    }
  }
  return text.size();
}

/// Where a text has keys, in one pass over its characters outside of strings and comments.
class KeyWatch {
 public:
  /// @returns whether a key, or a table's name, may begin after this character
  bool takes(char c) {
    if (c == '=') {
      is_key_ = false;
    } else if (!is_key_ && (c == '[' || c == '{')) {
      open_.push_back(c);
      is_key_ = c == '{';
    } else if (!open_.empty() && (c == ']' || c == '}')) {
      open_.pop_back();
      is_key_ = false;
    } else if (c == ',') {
      is_key_ = open_.empty() || open_.back() == '{';
    } else if (c == '\n') {
      is_key_ = is_key_ || open_.empty();
    } else {
      return c == '[' || c == ']';
    }
    return true;
  }

  [[nodiscard]] bool is_key() const noexcept { return is_key_; }

  /// Of lists and inline tables that are open.
  [[nodiscard]] std::size_t levels() const noexcept { return open_.size(); }

 private:
  std::string open_;  // the brackets of the value that are not closed yet
  bool is_key_ = true;
};

/// The beginning of a key, for an error.
std::string beginning(std::string_view key) {
  constexpr std::size_t kBytesMost = 60;
  key.remove_prefix(std::min(key.find_first_not_of(" \t"), key.size()));
  return "'" + text::printable(key.substr(0, kBytesMost)) + "...'";
}

struct TooDeep {
  int line = 0;
  std::string why;
};

/// The TOML library and the functions here call themselves for each part of "a.b.c" and for each level of "[[[1]]]", so
/// that thousands of them would overflow the stack.
/// @returns the first key of too many parts, or the first list or inline table of too many levels
std::optional<TooDeep> find_too_deep(std::string_view text) {
  KeyWatch watch;
  std::size_t parts = 1;
  std::size_t begin = 0;
  const auto at_line_of = [&](std::size_t at, std::string why) {
    return TooDeep{.line = static_cast<int>(1 + std::ranges::count(text.substr(0, at), '\n')), .why = std::move(why)};
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = end_of_string(text, i);
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (watch.takes(c)) {
      parts = 1;
      begin = i + 1;
      if (watch.levels() > kTomlLevelsMost) {
        return at_line_of(
            i, "lists and tables must be nested at most " + std::to_string(kTomlLevelsMost) + " deep, got more");
      }
    } else if (c == '.' && watch.is_key() && ++parts > kTomlKeyPartsMost) {
      return at_line_of(i, "a key must have at most " + std::to_string(kTomlKeyPartsMost) +
                               " parts, as a.b has two, got " + beginning(text.substr(begin, i - begin)));
    }
    ++i;
  }
  return {};
}

void check_size(std::string_view text) {
  if (text.size() <= kTomlBytesMost) return;
  throw ConfigError("must have at most " + std::to_string(kTomlBytesMost) + " bytes, got " +
                    std::to_string(text.size()));
}

std::string as_text(const std::string& text) {
  if (text.find_first_of("'\n\r\t") == std::string::npos) return "'" + text + "'";
  control::ClassicText quoted;
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
    check_size(text);
  } catch (const ConfigError& error) {
    throw ConfigError(text::printable(place) + ": " + error.what());
  }
  if (const auto deep = find_too_deep(text)) {
    throw ConfigError(text::printable(place) + ":" + std::to_string(deep->line) + ": " + deep->why);
  }
  try {
    return converted(toml::parse(text, place));
  } catch (const toml::parse_error& error) {
    throw ConfigError(text::printable(place + ":" + std::to_string(error.source().begin.line) +
                                      ": not TOML: " + std::string(error.description())));
  }
}

Node parse_toml_value(std::string_view text, int line) {
  const std::string whole = std::string(static_cast<std::size_t>(line) - 1, '\n') + "value = " + std::string(text);
  check_size(whole);
  if (const auto deep = find_too_deep(whole)) throw ConfigError(deep->why);
  try {
    const toml::table wrapped = toml::parse(whole);
    // More than one key: the value had lines of its own.
    if (wrapped.size() == 1) return converted(wrapped.begin()->second);
  } catch (const toml::parse_error&) {
  }
  throw ConfigError("must be a value as TOML writes it, got '" + text::printable(text) + "'");
}

}  // namespace forcebound::config
