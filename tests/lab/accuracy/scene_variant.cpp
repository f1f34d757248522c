#include "tests/lab/accuracy/scene_variant.hpp"

#include <toml++/toml.h>

#include <sstream>
#include <stdexcept>

#include "forcebound/text/names.hpp"

namespace forcebound::lab {
namespace {

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    }
    if (c == separator && depth == 0 && quote == 0) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::vector<std::string> keys_of(const toml::table& table) {
  std::vector<std::string> keys;
  for (const auto& [key, node] : table) keys.emplace_back(key.str());
  return keys;
}

toml::table& named(toml::array& tables, const std::string& kind, const std::string& name) {
  std::vector<std::string> names;
  for (toml::node& node : tables) {
    if (!node.is_table()) continue;
    toml::table& table = *node.as_table();
    names.push_back(table["name"].value_or(std::string()));
    if (names.back() == name) return table;
  }
  throw std::invalid_argument("no [[" + kind + "]] named '" + name + "'" + text::suggestion(name, names));
}

/// The table in which the last part of the key lies.
toml::table& table_of(toml::table& scene, const std::vector<std::string>& path) {
  toml::table* table = &scene;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    // The one table that may be left out of a scene that has what it is about.
    if (i == 0 && path[i] == "bodies" && scene.contains("body")) scene.insert("bodies", toml::table());
    toml::node* const node = table->get(path[i]);
    if (node == nullptr) {
      throw std::invalid_argument("the scene has no '" + path[i] + "'" + text::suggestion(path[i], keys_of(*table)));
    }
    if (node->is_array() && i + 2 < path.size()) {
      table = &named(*node->as_array(), path[i], path[i + 1]);
      ++i;
    } else if (node->is_table()) {
      table = node->as_table();
    } else {
      throw std::invalid_argument("'" + path[i] + "' of the scene is no table");
    }
  }
  return *table;
}

}  // namespace

Sweep parse_sweep(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size()) {
    throw std::invalid_argument("a sweep must be KEY=VALUE,VALUE,..., got '" + std::string(text) + "'");
  }
  return {std::string(text.substr(0, equals)), split(text.substr(equals + 1), ',')};
}

std::string scene_variant(std::string_view scene_text, const std::string& key, const std::string& value) {
  toml::table scene = toml::parse(scene_text);
  const std::vector<std::string> path = split(key, '.');
  toml::table& table = table_of(scene, path);
  toml::table wrapped;
  try {
    wrapped = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    throw std::invalid_argument(key + " must be a value as TOML writes it, got '" + value + "'");
  }
  table.insert_or_assign(path.back(), *wrapped.get("value"));
  std::ostringstream text;
  text << scene;
  return text.str();
}

}  // namespace forcebound::lab
