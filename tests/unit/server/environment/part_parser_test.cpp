#include "forcebound/server/environment/part_parser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/scene_files.hpp"

namespace forcebound::server {
namespace {

std::vector<scene::SceneObject> rebuilt(const std::vector<scene::SceneObject>& parts, const scene::Scene& scene) {
  static const scene::Registry kRegistry = scene::Registry::standard();
  std::vector<scene::SceneObject> made;
  made.reserve(parts.size());
  for (const scene::SceneObject& part : parts) {
    scene::PartDescription same{.name = part.name};
    if (part.shape) same.shape = {part.shape_kind, part.shape_values};
    for (const scene::RequestedEffect& effect : part.effects) same.effects.push_back({effect.name, effect.values});
    made.push_back(scene::make_part(same, kRegistry, std::max(1, scene.facts().degrees_of_freedom)));
  }
  return made;
}

/// Compares the forces of both scenes on random strokes about a part.
void expect_the_same_forces(const std::shared_ptr<const scene::Scene>& one,
                            const std::shared_ptr<const scene::Scene>& other) {
  const auto rows = static_cast<Eigen::Index>(std::max(1, one->facts().degrees_of_freedom));
  scene::SceneState in_one(one, static_cast<std::uint32_t>(rows));
  scene::SceneState in_other(other, static_cast<std::uint32_t>(rows));
  for (int i = 0; i < 1000; ++i) {
    const auto part = static_cast<std::size_t>(i / 100) % one->parts();
    const double turn = 0.05 * i;
    const scene::Point place = one->on_surface_m(part) + 0.005 * scene::Point(std::sin(turn), std::sin(0.77 * turn + 1),
                                                                              std::sin(1.3 * turn + 3));
    const time::Nanoseconds now = std::chrono::milliseconds{i};
    EXPECT_EQ(in_one.answer(place.head(rows), now).force, in_other.answer(place.head(rows), now).force) << i;
  }
}

TEST(PartParser, PartsCanBeRemadeFromTheirDescriptions) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  int scenes = 0;
  for (const std::string& name : test::scene_files()) {
    const auto scene = load_scene(name);
    if (!scene->dynamic_models().empty() || scene->parts() == 0) continue;
    SCOPED_TRACE(name);
    const auto again = std::make_shared<const scene::Scene>(
        scene->facts(),
        scene::SceneParts{.objects = rebuilt(scene->objects(), *scene), .fields = rebuilt(scene->fields(), *scene)});
    expect_the_same_forces(scene, again);
    ++scenes;
  }
  EXPECT_GT(scenes, 10);
}

}  // namespace
}  // namespace forcebound::server
