#include "tests/lab/accuracy/scene_variant.hpp"

#include <toml++/toml.h>

#include <sstream>
#include <stdexcept>

#include "forcebound/server/scene/scene_key.hpp"
#include "forcebound/text/split.hpp"

namespace forcebound::lab {
namespace {

std::string to_text(const toml::table& scene) {
  std::ostringstream text;
  text << scene;
  return text.str();
}

}  // namespace

Sweep parse_sweep(std::string_view sweep) {
  const auto equals = sweep.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == sweep.size()) {
    throw std::invalid_argument("a sweep must be KEY=VALUE,VALUE,..., got '" + std::string(sweep) + "'");
  }
  return {std::string(sweep.substr(0, equals)), text::split(sweep.substr(equals + 1), ',')};
}

std::string scene_variant(std::string_view scene_text, const std::string& key, const std::string& value) {
  toml::table scene = toml::parse(scene_text);
  toml::table wrapped;
  try {
    wrapped = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    throw std::invalid_argument(key + " must be a value as TOML writes it, got '" + value + "'");
  }
  server::set_scene_key(scene, key, *wrapped.get("value"));
  return to_text(scene);
}

std::string without_levels(std::string_view scene_text) {
  toml::table scene = toml::parse(scene_text);
  scene.erase("accuracy");
  if (toml::table* const facts = scene["scene"].as_table()) facts->erase("accuracy");
  return to_text(scene);
}

}  // namespace forcebound::lab
