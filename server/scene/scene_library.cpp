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

}  // namespace

SceneLibrary SceneLibrary::shipped(EffectRegistry registry) {
  SceneLibrary library;
  library.registry_ = std::make_shared<const EffectRegistry>(std::move(registry));
  for (const EmbeddedText& scene : shipped_scenes()) {
    library.scenes_.push_back({.name = std::string(scene.name), .text = scene.text});
  }
  return library;
}

void SceneLibrary::add(std::shared_ptr<const Scene> scene) {
  for (Entry& known : scenes_) {
    if (known.name != scene->facts().name) continue;
    known.scene = std::move(scene);
    return;
  }
  Entry& entry = scenes_.emplace_back();
  entry.name = scene->facts().name;
  entry.scene = std::move(scene);
}

std::shared_ptr<const Scene> SceneLibrary::find(std::string_view name) const {
  const auto found =
      std::find_if(scenes_.begin(), scenes_.end(), [&](const Entry& known) { return known.name == name; });
  if (found == scenes_.end()) return nullptr;
  if (!found->scene) found->scene = parse_scene(found->text, "scenes/" + found->name + ".toml", *registry_);
  return found->scene;
}

std::vector<std::string> SceneLibrary::all_names() const {
  std::vector<std::string> names;
  names.reserve(scenes_.size());
  for (const Entry& known : scenes_) names.push_back(known.name);
  return names;
}

std::string SceneLibrary::names() const { return text::join(all_names()); }

std::string SceneLibrary::unknown_scene_text(std::string_view name) const {
  return "no scene '" + std::string(name) + "'" + text::suggestion(name, all_names());
}

std::shared_ptr<const Scene> load_scene(const std::string& name_or_file, const EffectRegistry& registry) {
  const bool is_file = name_or_file.find('/') != std::string::npos || name_or_file.ends_with(".toml");
  if (is_file) return parse_scene(read_file(name_or_file), name_or_file, registry);
  const SceneLibrary library = SceneLibrary::shipped(registry);
  if (auto scene = library.find(name_or_file)) return scene;
  throw SceneError(library.unknown_scene_text(name_or_file) + "; a file is given as FILE.toml");
}

}  // namespace forcebound::server
