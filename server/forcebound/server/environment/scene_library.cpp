#include "forcebound/server/environment/scene_library.hpp"

#include <algorithm>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "forcebound/config/node.hpp"
#include "forcebound/server/environment/scene_environment.hpp"
#include "forcebound/server/environment/shipped_scenes.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

std::string read_file(const std::string& path) try {
  return text::read_file(path, config::kTomlBytesMost);
} catch (const std::runtime_error& error) {
  throw SceneError(error.what());
}

std::string file_of(const std::string& shipped) { return "scenes/" + shipped + ".toml"; }

}  // namespace

class SceneLibrary::Shelf {
 public:
  using Compile = std::function<std::shared_ptr<const scene::Scene>()>;
  struct Entry {
    std::string name;
    Compile compile{};
    std::shared_ptr<const scene::Scene> scene{};  // null: not yet compiled
  };

  void put(Entry entry) {
    const std::lock_guard lock(guard_);
    const auto known = std::ranges::find(entries_, entry.name, &Entry::name);
    if (known == entries_.end()) {
      entries_.push_back(std::move(entry));
    } else {
      *known = std::move(entry);
    }
  }

  /// Without a scene and a function to compile one: the name is unknown.
  [[nodiscard]] Entry get(std::string_view name) const {
    const std::lock_guard lock(guard_);
    const auto found = std::ranges::find(entries_, name, &Entry::name);
    return found == entries_.end() ? Entry{} : *found;
  }

  [[nodiscard]] std::shared_ptr<const scene::Scene> compiled(std::string_view name) {
    if (const Entry known = get(name); known.scene || !known.compile) return known.scene;
    const std::lock_guard compiling(compiling_);
    // Another may have compiled it meanwhile.
    Entry entry = get(name);
    if (entry.scene || !entry.compile) return entry.scene;
    entry.scene = entry.compile();
    put(entry);
    return entry.scene;
  }

  [[nodiscard]] std::vector<std::string> names() const {
    const std::lock_guard lock(guard_);
    std::vector<std::string> names;
    names.reserve(entries_.size());
    for (const Entry& known : entries_) names.push_back(known.name);
    return names;
  }

 private:
  std::mutex compiling_;
  mutable std::mutex guard_;
  std::vector<Entry> entries_;
};

SceneLibrary::SceneLibrary() : shelf_(std::make_shared<Shelf>()) {}

SceneLibrary SceneLibrary::shipped(scene::Registry registry, scene::MeasureCost measure) {
  struct Reading {
    scene::Registry registry;
    scene::MeasureCost measure;
  };
  SceneLibrary library;
  const auto by = std::make_shared<const Reading>(Reading{std::move(registry), std::move(measure)});
  for (const text::EmbeddedText& scene : shipped_scenes()) {
    const std::string name(scene.name);
    library.shelf_->put({.name = name, .compile = [by, name, text = scene.text] {
                           return parse_scene(text, file_of(name), by->registry, by->measure);
                         }});
  }
  return library;
}

void SceneLibrary::add(std::shared_ptr<const scene::Scene> scene) {
  const std::string name = scene->facts().name;
  shelf_->put({.name = name, .scene = std::move(scene)});
}

std::shared_ptr<const scene::Scene> SceneLibrary::find(std::string_view name) const { return shelf_->compiled(name); }

std::vector<std::string> SceneLibrary::all_names() const { return shelf_->names(); }

std::string SceneLibrary::names() const { return text::join(all_names()); }

std::string SceneLibrary::unknown_scene_text(std::string_view name) const {
  return "no scene '" + text::printable(name) + "'" + text::suggestion(name, all_names());
}

SceneLibrary::operator EnvironmentLibrary() const {
  EnvironmentLibrary environments;
  for (const std::string& name : all_names()) {
    environments.add_later(
        {.name = name, .make = [scenes = *this, name] { return scene_environment(scenes.find(name)); }});
  }
  return environments;
}

bool is_scene_file(std::string_view name_or_file) noexcept {
  return name_or_file.find('/') != std::string_view::npos || name_or_file.ends_with(".toml");
}

SceneSource scene_source(const std::string& name_or_file) {
  if (is_scene_file(name_or_file)) return {read_file(name_or_file), name_or_file};
  for (const text::EmbeddedText& scene : shipped_scenes()) {
    if (scene.name == name_or_file) return {std::string(scene.text), file_of(name_or_file)};
  }
  throw std::invalid_argument(SceneLibrary::shipped().unknown_scene_text(name_or_file) +
                              "; a file is given as FILE.toml");
}

std::shared_ptr<const scene::Scene> load_scene(const std::string& name_or_file, const scene::Registry& registry,
                                               const scene::MeasureCost& measure,
                                               std::span<const std::string> folders) {
  const SceneSource source = scene_source(name_or_file);
  return parse_scene(source.text, source.file, registry, measure, folders);
}

}  // namespace forcebound::server
