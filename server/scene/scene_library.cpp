#include "forcebound/server/scene/scene_library.hpp"

#include <algorithm>
#include <stdexcept>

#include "embedded/shipped_scenes.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

std::string read_file(const std::string& path) try {
  return text::read_file(path);
} catch (const std::runtime_error& error) {
  throw SceneError(error.what());
}

std::vector<std::string> names_of(const std::vector<std::shared_ptr<const Scene>>& scenes) {
  std::vector<std::string> names;
  names.reserve(scenes.size());
  for (const auto& scene : scenes) names.push_back(scene->facts().name);
  return names;
}

}  // namespace

SceneLibrary SceneLibrary::shipped(const EffectRegistry& registry) {
  SceneLibrary library;
  for (const EmbeddedText& scene : shipped_scenes()) {
    library.add(parse_scene(scene.text, "scenes/" + std::string(scene.name) + ".toml", registry));
  }
  return library;
}

void SceneLibrary::add(std::shared_ptr<const Scene> scene) {
  for (auto& known : scenes_) {
    if (known->facts().name != scene->facts().name) continue;
    known = std::move(scene);
    return;
  }
  scenes_.push_back(std::move(scene));
}

std::shared_ptr<const Scene> SceneLibrary::find(std::string_view name) const noexcept {
  for (const auto& scene : scenes_) {
    if (scene->facts().name == name) return scene;
  }
  return nullptr;
}

std::string SceneLibrary::names() const { return text::join(names_of(scenes_)); }

std::string SceneLibrary::unknown_scene_text(std::string_view name) const {
  return "no scene '" + std::string(name) + "'" + text::suggestion(name, names_of(scenes_));
}

std::shared_ptr<const Scene> load_scene(const std::string& name_or_file, const EffectRegistry& registry) {
  const bool is_file = name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".toml");
  if (is_file) return parse_scene(read_file(name_or_file), name_or_file, registry);
  const SceneLibrary library = SceneLibrary::shipped(registry);
  if (auto scene = library.find(name_or_file)) return scene;
  throw SceneError(library.unknown_scene_text(name_or_file) + "; a file is given as FILE.toml");
}

}  // namespace forcebound::server
