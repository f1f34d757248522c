#pragma once

#include <string>
#include <vector>

#include "forcebound/scene/effects/registry.hpp"

namespace forcebound::server {

/// A key that a table of a scene file may have, for people.
struct SchemaKey {
  std::string key;
  std::string meaning;
  std::string values;    ///< "> 0", "`true` or `false`"
  std::string preset{};  ///< where the scene is silent; empty: it must not be
};

SchemaKey described(const scene::EffectParameter& parameter);

/// How a file's mesh or tissue is placed, and what of that a body made in place has.
SchemaKey rotation_key(std::string_view meaning);
std::vector<SchemaKey> placement_keys();

/// A table of a scene file, all its keys, and what it is for.
struct SchemaTable {
  std::string title;
  std::string text;
  std::vector<SchemaKey> keys;
};

/// [scene], [[object]] and [[field]]. The keys of the last two lack the effects' own tables.
std::vector<SchemaTable> part_tables();

/// `shape` of an [[object]], one table for each kind, its title; all lack the key `kind`.
std::vector<SchemaTable> shape_tables();

/// [bodies], [[body]] and [[tissue]], with the tables within them.
std::vector<SchemaTable> dynamic_model_tables();

/// The page that tells a scene's author all that a scene file may have: server/scenes/README.md, as Markdown.
std::string schema(const scene::EffectRegistry& registry);

/// The short scene on top of that page.
std::string schema_example();

}  // namespace forcebound::server
