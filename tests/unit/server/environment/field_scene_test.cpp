// Every field in scenes of one, two and three axes, and every shipped scene.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/plain_values.hpp"
#include "tests/support/scene_files.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;

/// What holds needs a button.
const control::Handle kPressed{.buttons = 1};

/// `effects = [...]` with one effect and its table, on so many axes.
std::string effect_text(const std::string& name, int axes) {
  static const scene::Registry kRegistry = scene::Registry::standard();
  const config::Values values = test::plain_values(*kRegistry.find_effect(name));
  std::string table;
  for (const auto& [key, value] : values.all()) {
    table += (table.empty() ? "" : ", ") + key + " = ";
    if (const auto* point = std::get_if<scene::Point>(&value)) table += config::to_text(*point, axes);
    if (const auto* number = std::get_if<double>(&value)) table += text::to_text(*number);
  }
  return "effects = ['" + name + "']\n" + name + " = { " + table + " }\n";
}

std::shared_ptr<const scene::Scene> scene_of_field(const std::string& field, int axes) {
  return parse_scene("[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = " + std::to_string(axes) +
                         "\n[[field]]\nname = 'x'\n" + effect_text(field, axes),
                     "x.toml");
}

class EveryField : public testing::TestWithParam<std::string> {};

TEST_P(EveryField, IsFiniteOnAnyAxesFromItsCentreToFarAway) {
  for (int axes = 1; axes <= 3; ++axes) {
    const auto device = static_cast<std::uint32_t>(axes == 3 ? 6 : axes);
    scene::SceneState state(scene_of_field(GetParam(), axes), device);
    milliseconds now{0};
    for (const double far_m : {1.0, 1.0, 0.0, 1e-300, 1 + 1e-9, 1.01, -0.3, 0.7, 1e3, -1e6, 1e9, 1.0}) {
      control::Vector position = control::Vector::Zero(device);
      position.head(axes).setConstant(far_m);
      const scene::Answer answer = state.answer(position, now += milliseconds(7), {}, false, kPressed);
      ASSERT_TRUE(answer.force.allFinite()) << axes << " axes at " << far_m;
      ASSERT_TRUE(state.quarantined().empty()) << axes << " axes at " << far_m;
      ASSERT_EQ(answer.force.rows(), static_cast<Eigen::Index>(device));
      ASSERT_EQ(answer.contact_normal.rows(), 0) << "a field is no contact";
      ASSERT_EQ(answer.force.tail(answer.force.rows() - axes).norm(), 0) << "no torque";
    }
  }
}

TEST_P(EveryField, IsFeltAlongTheAxesOfAScene) {
  for (int axes = 1; axes <= 3; ++axes) {
    // On one axis every place lies on every line along it.
    if (axes == 1 && GetParam() == "spring_to_line") continue;
    scene::SceneState state(scene_of_field(GetParam(), axes), static_cast<std::uint32_t>(axes));
    double felt_N = 0;
    for (int i = 0; i < 10; ++i) {
      const control::Vector position = 0.3 * i * control::Vector::Unit(axes, axes - 1);
      felt_N = std::max(felt_N, state.answer(position, milliseconds(10 * i), {}, false, kPressed).force.norm());
    }
    EXPECT_GT(felt_N, 1e-3) << axes;
  }
}

TEST_P(EveryField, WithinAShapeIsZeroOutsideOfIt) {
  const std::string ball =
      "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n[[object]]\nname = 'x'\n"
      "shape = { kind = 'sphere', center_m = [1, 0, 0], radius_m = 0.5 }\n" +
      effect_text(GetParam(), 3);
  scene::SceneState state(parse_scene(ball, "x.toml"), 3);
  double felt_N = 0;
  for (int i = 0; i < 10; ++i) {
    felt_N = std::max(
        felt_N,
        state.answer(test::vector_of({1, 0.02 * i, 0}), milliseconds(10 * i), {}, false, kPressed).force.norm());
  }
  EXPECT_GT(felt_N, 1e-3);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(state.answer(test::vector_of({1, 0.51 + 0.02 * i, 0}), milliseconds(100 + 10 * i), {}, false, kPressed)
                  .force.norm(),
              0);
  }
}

std::vector<std::string> fields_that_ship() {
  const scene::Registry registry = scene::Registry::standard();
  std::vector<std::string> names;
  for (const scene::EffectKind& kind : registry.effects()) {
    if (kind.place == scene::EffectPlace::space) names.emplace_back(kind.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(FieldScene, EveryField, testing::ValuesIn(fields_that_ship()),
                         [](const auto& field) { return field.param; });

class EveryShippedScene : public testing::TestWithParam<std::string> {
 protected:
  static std::uint32_t device_of(const scene::Scene& scene) { return scene.accepts(3) ? 3 : 2; }

  void SetUp() override {
    const bool asks_for_bodies = scene_source(GetParam()).text.find("[[body]]") != std::string::npos;
    if (asks_for_bodies && !has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  }

  /// A walk through the very centre and 80 mm around it.
  static control::Vector place(int step, std::uint32_t rows) {
    const double t = 0.01 * step;
    return 0.08 * std::sin(0.37 * t) * test::vector_of({std::sin(t), std::cos(1.3 * t), std::sin(1.7 * t)}).head(rows);
  }
};

TEST_P(EveryShippedScene, IsFiniteAndSoundEverywhere) {
  const auto scene = load_scene(GetParam());
  const std::uint32_t device = device_of(*scene);
  scene::SceneState state(scene, device);
  for (int step = 0; step < 2500; ++step) {
    const scene::Answer answer = state.answer(place(step, device), milliseconds(step));
    ASSERT_TRUE(answer.force.allFinite()) << step;
    ASSERT_TRUE(state.quarantined().empty()) << step;
    ASSERT_NEAR(answer.contact_normal.norm(), answer.penetration_m > 0 ? 1 : 0, 1e-12) << step;
  }
}

TEST_P(EveryShippedScene, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto scene = load_scene(GetParam());
  const std::uint32_t device = device_of(*scene);
  scene::SceneState state(scene, device);
  std::vector<control::Vector> path(3000);
  for (std::size_t step = 0; step < path.size(); ++step) path[step] = place(static_cast<int>(step), device);
  const test::AllocationGuard guard;
  milliseconds now{0};
  for (const control::Vector& position : path) (void)state.answer(position, now += milliseconds(1));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

INSTANTIATE_TEST_SUITE_P(FieldScene, EveryShippedScene, testing::ValuesIn(test::scene_files()),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace forcebound::server
