#pragma once

#include <string>

#include "forcebound/config/node.hpp"

namespace forcebound::server {

/// Gives a key of a scene file another value; it may be new, the table that it is in may not. A table of an array, such
/// as [[tissue]], is found by its name: "tissue.pad.shape.cells".
/// @throws std::invalid_argument naming what is not there
void set_scene_key(config::Node& scene, const std::string& key, const config::Node& value);

/// The same with a value as TOML writes it. It counts as written where the one was that it replaces, or, if the key is
/// new, where its table begins: so errors about it name a line of the file.
void set_scene_key(config::Node& scene, const std::string& key, const std::string& value);

}  // namespace forcebound::server
