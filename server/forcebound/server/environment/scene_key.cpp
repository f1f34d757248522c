#include "forcebound/server/environment/scene_key.hpp"

#include <stdexcept>
#include <vector>

#include "forcebound/config/config_error.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/split.hpp"

namespace forcebound::server {
namespace {

using config::Node;

Node& named(Node::List& tables, const std::string& kind, const std::string& name) {
  std::vector<std::string> names;
  for (Node& node : tables) {
    names.push_back(node.text_at("name"));
    if (node.as<Node::Table>() != nullptr && names.back() == name) return node;
  }
  throw std::invalid_argument("no [[" + kind + "]] named '" + name + "'" + text::suggestion(name, names));
}

Node& child(Node& table, const std::string& name) {
  Node::Table& all = *table.as<Node::Table>();
  if (const auto found = all.find(name); found != all.end()) return found->second;
  std::vector<std::string> keys;
  for (const auto& [key, node] : all) keys.push_back(key);
  throw std::invalid_argument("the scene has no '" + name + "'" + text::suggestion(name, keys));
}

/// The table in which the last part of the key lies.
Node& table_of(Node& scene, const std::vector<std::string>& path) {
  // [bodies] may be absent although the scene has a [[body]]: a new key creates it.
  if (path.front() == "bodies" && scene.find("body") != nullptr) scene.as<Node::Table>()->try_emplace("bodies");
  Node* table = &scene;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    table = &child(*table, path[i]);
    if (auto* const list = table->as<Node::List>(); list != nullptr && i + 2 < path.size()) {
      table = &named(*list, path[i], path[i + 1]);
      ++i;
    } else if (table->as<Node::Table>() == nullptr) {
      throw std::invalid_argument("'" + path[i] + "' of the scene is no table");
    }
  }
  return *table;
}

}  // namespace

void set_scene_key(Node& scene, const std::string& key, const Node& value) {
  const std::vector<std::string> path = text::split_outside_brackets(key, '.');
  table_of(scene, path).as<Node::Table>()->insert_or_assign(path.back(), value);
}

void set_scene_key(Node& scene, const std::string& key, const std::string& value) {
  const std::vector<std::string> path = text::split_outside_brackets(key, '.');
  const Node& table = table_of(scene, path);
  const Node* const old = table.find(path.back());
  try {
    set_scene_key(scene, key, config::parse_toml_value(value, (old != nullptr ? *old : table).line));
  } catch (const config::ConfigError& error) {
    throw std::invalid_argument(key + " " + error.what());
  }
}

}  // namespace forcebound::server
