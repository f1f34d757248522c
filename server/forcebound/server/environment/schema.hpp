#pragma once

#include <string>
#include <vector>

#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/registry.hpp"

namespace forcebound::server {

/// [scene], [accuracy], [[object]] and [[field]]. The keys of the last two lack the effects' own tables.
std::vector<config::TableDescription> part_tables();

/// [bodies], [[body]] and [[tissue]], with the tables within them.
std::vector<config::TableDescription> dynamic_model_tables();

/// The page that tells a scene's author all that a scene file may have, from what its readers declare:
/// server/scenes/README.md, as Markdown.
std::string schema(const scene::Registry& registry);

/// The short scene on top of that page.
std::string schema_example();

}  // namespace forcebound::server
