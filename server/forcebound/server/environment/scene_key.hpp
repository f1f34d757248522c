#pragma once

#include <string>

#include "forcebound/config/node.hpp"

namespace forcebound::server {

/// Sets a key of a scene file. The key may be new, but its table must exist. A table of an array, such as [[tissue]],
/// is addressed by its name: "tissue.pad.shape.cells".
/// @throws std::invalid_argument naming the missing table
void set_scene_key(config::Node& scene, const std::string& key, const config::Node& value);

/// As above, with a value in TOML syntax. Its line is that of the replaced value, or, if the key is new, the first line
/// of its table, so that errors about it name a line of the file.
void set_scene_key(config::Node& scene, const std::string& key, const std::string& value);

}  // namespace forcebound::server
