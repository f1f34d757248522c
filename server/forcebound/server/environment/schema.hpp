#pragma once

#include <string>
#include <vector>

#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/registry.hpp"

namespace forcebound::server {

/// Descriptions of [scene], [accuracy], [[object]] and [[field]]; the last two without the effects' own tables.
std::vector<config::TableDescription> part_tables();

/// Descriptions of [bodies], [[body]] and [[tissue]], and of the tables within them.
std::vector<config::TableDescription> dynamic_model_tables();

/// The reference page of scene files, generated from the declarations that their readers use:
/// server/scenes/README.md, in Markdown.
std::string schema(const scene::Registry& registry);

/// The example scene of that page.
std::string schema_example();

}  // namespace forcebound::server
