#include "forcebound/server/environment/scene_key.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/text/names.hpp"
#include "forcebound/text/split.hpp"

namespace forcebound::server {
namespace {

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

void set_scene_key(toml::table& scene, const std::string& key, const toml::node& value) {
  const std::vector<std::string> path = text::split_outside_brackets(key, '.');
  table_of(scene, path).insert_or_assign(path.back(), value);
}

void set_scene_key(toml::table& scene, const std::string& key, const std::string& value) {
  const std::vector<std::string> path = text::split_outside_brackets(key, '.');
  toml::table& table = table_of(scene, path);
  const toml::node* const old = table.get(path.back());
  const toml::source_region& place = (old != nullptr ? *old : table).source();
  const toml::source_index lines_before = place.begin.line > 0 ? place.begin.line - 1 : 0;
  toml::table wrapped;
  try {
    wrapped = toml::parse(std::string(lines_before, '\n') + "value = " + value);
  } catch (const toml::parse_error&) {
  }
  // More than one key: the value had lines of its own.
  if (wrapped.size() != 1) {
    throw std::invalid_argument(key + " must be a value as TOML writes it, got '" + value + "'");
  }
  table.insert_or_assign(path.back(), std::move(*wrapped.get("value")));
}

}  // namespace forcebound::server
