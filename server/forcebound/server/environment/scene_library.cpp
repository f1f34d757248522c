#include "forcebound/server/environment/scene_library.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "forcebound/config/node.hpp"
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

/// What copies of a library have compiled. One is compiled at a time; who wants one that is there waits for none.
class SceneLibrary::Compiled {
 public:
  std::shared_ptr<const scene::Scene> get_or(const std::string& name,
                                             const std::function<std::shared_ptr<const scene::Scene>()>& compile) {
    if (auto scene = find(name)) return scene;
    const std::lock_guard compiling(compiling_);
    // Another may have compiled it meanwhile.
    if (auto scene = find(name)) return scene;
    auto scene = compile();
    const std::lock_guard lock(guard_);
    scenes_[name] = scene;
    return scene;
  }

 private:
  [[nodiscard]] std::shared_ptr<const scene::Scene> find(const std::string& name) const {
    const std::lock_guard lock(guard_);
    const auto found = scenes_.find(name);
    return found == scenes_.end() ? nullptr : found->second;
  }

  std::mutex compiling_;
  mutable std::mutex guard_;
  std::map<std::string, std::shared_ptr<const scene::Scene>> scenes_;
};

struct SceneLibrary::Shelf {
  struct Entry {
    std::string name;
    std::string_view text{};                      // of a scene that ships
    std::shared_ptr<const scene::Scene> scene{};  // null: not yet compiled
    bool coming = false;
    std::string why_not{};
  };

  Entry* find(std::string_view name) {
    const auto found = std::ranges::find(entries, name, &Entry::name);
    return found == entries.end() ? nullptr : &*found;
  }

  std::shared_ptr<const scene::Registry> registry{};  // for those that ship
  scene::MeasureCost measure{};
  std::function<void(Compilation)> elsewhere{};
  std::vector<Entry> entries{};
  std::shared_ptr<Compiled> compiled{};  ///< null: there are no copies

  [[nodiscard]] Compilation compilation_of(const Entry& entry) const {
    auto compile = [registry = registry, measure = measure, name = entry.name, text = entry.text] {
      return parse_scene(text, file_of(name), *registry, measure);
    };
    if (!compiled) return {entry.name, std::move(compile)};
    return {entry.name, [compiled = compiled, name = entry.name, compile = std::move(compile)] {
              return compiled->get_or(name, compile);
            }};
  }
};

SceneLibrary::SceneLibrary() : shelf_(std::make_shared<Shelf>()) {}

SceneLibrary SceneLibrary::shipped(scene::Registry registry, scene::MeasureCost measure) {
  SceneLibrary library;
  library.shelf_->registry = std::make_shared<const scene::Registry>(std::move(registry));
  library.shelf_->measure = std::move(measure);
  for (const text::EmbeddedText& scene : shipped_scenes()) {
    library.shelf_->entries.push_back({.name = std::string(scene.name), .text = scene.text});
  }
  return library;
}

SceneLibrary SceneLibrary::copy() const {
  if (!shelf_->compiled) shelf_->compiled = std::make_shared<Compiled>();
  SceneLibrary other;
  *other.shelf_ = *shelf_;
  other.shelf_->elsewhere = {};
  for (Shelf::Entry& entry : other.shelf_->entries) entry.coming = false;
  return other;
}

void SceneLibrary::add(std::shared_ptr<const scene::Scene> scene) {
  Shelf::Entry* entry = shelf_->find(scene->facts().name);
  if (entry == nullptr) entry = &shelf_->entries.emplace_back();
  entry->name = scene->facts().name;
  entry->scene = std::move(scene);
}

void SceneLibrary::compile_elsewhere(std::function<void(Compilation)> elsewhere) {
  shelf_->elsewhere = std::move(elsewhere);
  for (Shelf::Entry& entry : shelf_->entries) entry.coming = false;
}

void SceneLibrary::give_up(std::string_view name, std::string why) {
  Shelf::Entry* const entry = shelf_->find(name);
  if (entry == nullptr) return;
  entry->coming = false;
  entry->why_not = std::move(why);
}

std::shared_ptr<const scene::Scene> SceneLibrary::find(std::string_view name) const {
  Shelf::Entry* const entry = shelf_->find(name);
  if (entry == nullptr) return nullptr;
  if (!entry->scene) entry->scene = shelf_->compilation_of(*entry).compile();
  return entry->scene;
}

Requested<scene::Scene> SceneLibrary::request(std::string_view name) const {
  Shelf::Entry* const entry = shelf_->find(name);
  if (entry == nullptr || entry->scene || !shelf_->elsewhere) return {.found = find(name)};
  if (!entry->why_not.empty()) return {.why_not = std::exchange(entry->why_not, {})};
  if (!std::exchange(entry->coming, true)) shelf_->elsewhere(shelf_->compilation_of(*entry));
  return {.coming = true};
}

std::vector<std::string> SceneLibrary::all_names() const {
  std::vector<std::string> names;
  names.reserve(shelf_->entries.size());
  for (const Shelf::Entry& known : shelf_->entries) names.push_back(known.name);
  return names;
}

std::string SceneLibrary::names() const { return text::join(all_names()); }

std::string SceneLibrary::unknown_scene_text(std::string_view name) const {
  return "no scene '" + text::printable(name) + "'" + text::suggestion(name, all_names());
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
