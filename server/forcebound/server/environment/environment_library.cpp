#include "forcebound/server/environment/environment_library.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/server/environment/scene_environment.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {

struct EnvironmentLibrary::Shelf {
  explicit Shelf(SceneLibrary library) : scenes(std::move(library)) {}

  [[nodiscard]] std::shared_ptr<const EnvironmentKind> own(std::string_view name) const {
    const auto found = std::ranges::find_if(added, [&](const auto& kind) { return kind->name == name; });
    return found == added.end() ? nullptr : *found;
  }

  /// The single kind of each scene: clients of a shared scene must get the same one.
  std::shared_ptr<const EnvironmentKind> kind_of(const std::shared_ptr<const scene::Scene>& scene) {
    if (!scene) return nullptr;
    const std::string& name = scene->facts().name;
    auto entry = std::ranges::find_if(of_scenes, [&](const OfScene& known) { return known.kind->name == name; });
    if (entry == of_scenes.end()) entry = of_scenes.emplace(of_scenes.end());
    if (entry->scene != scene) {
      *entry = {scene, std::make_shared<const EnvironmentKind>(scene_environment(scene))};
    }
    return entry->kind;
  }

  struct OfScene {
    std::shared_ptr<const scene::Scene> scene;
    std::shared_ptr<const EnvironmentKind> kind;
  };

  SceneLibrary scenes;
  std::vector<std::shared_ptr<const EnvironmentKind>> added{};
  std::vector<OfScene> of_scenes{};
};

EnvironmentLibrary::EnvironmentLibrary() : EnvironmentLibrary(SceneLibrary{}) {}

EnvironmentLibrary::EnvironmentLibrary(SceneLibrary scenes) : shelf_(std::make_shared<Shelf>(std::move(scenes))) {}

EnvironmentLibrary EnvironmentLibrary::copy() const {
  EnvironmentLibrary other(shelf_->scenes.copy());
  other.shelf_->added = shelf_->added;
  return other;
}

void EnvironmentLibrary::add(EnvironmentKind kind) {
  if (kind.name.empty() || !kind.make) {
    throw std::invalid_argument("environment '" + kind.name + "' must have a name and a function that makes it");
  }
  std::erase_if(shelf_->added, [&](const auto& known) { return known->name == kind.name; });
  shelf_->added.push_back(std::make_shared<const EnvironmentKind>(std::move(kind)));
}

Requested<EnvironmentKind> EnvironmentLibrary::request(std::string_view name) const {
  if (auto own = shelf_->own(name)) return {.found = std::move(own)};
  Requested<scene::Scene> wanted = shelf_->scenes.request(name);
  return {.found = shelf_->kind_of(wanted.found), .coming = wanted.coming, .why_not = std::move(wanted.why_not)};
}

std::shared_ptr<const EnvironmentKind> EnvironmentLibrary::find(std::string_view name) const {
  if (auto own = shelf_->own(name)) return own;
  return shelf_->kind_of(shelf_->scenes.find(name));
}

std::string EnvironmentLibrary::unknown_text(std::string_view name) const {
  std::vector<std::string> names = shelf_->scenes.all_names();
  for (const auto& kind : shelf_->added) {
    if (std::ranges::find(names, kind->name) == names.end()) names.push_back(kind->name);
  }
  return "no scene '" + std::string(name) + "'" + text::suggestion(name, names);
}

const SceneLibrary& EnvironmentLibrary::scenes() const noexcept { return shelf_->scenes; }

}  // namespace forcebound::server
