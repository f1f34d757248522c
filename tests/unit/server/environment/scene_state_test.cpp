#include "forcebound/scene/scene_state.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <limits>
#include <numbers>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::scene {
namespace {

using server::load_scene;
using server::parse_scene;

using std::chrono::milliseconds;

using test::vector_of;

std::shared_ptr<const Scene> damped_plane() {
  return parse_scene(R"(
[scene]
name = "damped"
description = ""
degrees_of_freedom = 3
[[object]]
name = "table"
shape = { kind = "half_space", through_m = [0, 0, 0], normal = [0, 0, 1] }
effects = ["surface"]
surface = { stiffness_N_per_m = 1000, damping_N_s_per_m = 10 }
)",
                     "damped.toml");
}

TEST(SceneState, WallPushesBackAlongMinusXForEveryDevice) {
  for (std::uint32_t dof = 1; dof <= 6; ++dof) {
    SceneState state(load_scene("wall"), dof);
    Vector position = Vector::Constant(dof, 0.5);
    position[0] = 0.001;
    const Answer answer = state.answer(position, milliseconds{1});
    Vector expected = Vector::Zero(dof);
    expected[0] = -50;
    EXPECT_EQ(answer.force, expected) << dof;
    expected[0] = -1;
    EXPECT_EQ(answer.contact_normal, expected) << dof;
    EXPECT_EQ(answer.penetration_m, 0.001);
  }
}

TEST(SceneState, HoldsADeviceWhileItsButtonIsPressed) {
  SceneState state(load_scene("grasp"), 3);
  const auto force_x = [&](double x_m, std::uint32_t buttons) {
    static Nanoseconds now{0};
    return state.answer(vector_of({x_m, 0, 0}), now += milliseconds{100}, {}, false, {.buttons = buttons}).force[0];
  };
  EXPECT_EQ(force_x(0.01, 0), 0);
  EXPECT_EQ(force_x(0.01, 1), 0);
  EXPECT_NEAR(force_x(0.014, 1), -0.8, 0.01);
  EXPECT_EQ(force_x(0.014, 0), 0);
}

TEST(SceneState, NoContactIsNoForceAndNoNormal) {
  SceneState state(load_scene("wall"), 1);
  const Answer answer = state.answer(vector_of({-0.001}), milliseconds{1});
  EXPECT_EQ(answer.force, vector_of({0}));
  EXPECT_EQ(answer.contact_normal.rows(), 0);
  EXPECT_EQ(answer.penetration_m, 0);
}

TEST(SceneState, CirclePushesInwards) {
  SceneState state(load_scene("circle"), 2);
  const Answer answer = state.answer(vector_of({0.0246, 0.0328}), milliseconds{1});
  EXPECT_LT((answer.force - vector_of({-6, -8})).norm(), 1e-9);
}

TEST(SceneState, SphereOfASixDofDeviceHasNoTorque) {
  SceneState state(load_scene("sphere"), 6);
  const Answer answer = state.answer(vector_of({0, 0.019, 0, 1, 2, 3}), milliseconds{1});
  EXPECT_LT((answer.force - vector_of({0, 10, 0, 0, 0, 0})).norm(), 1e-9);
  EXPECT_EQ(answer.contact_normal, vector_of({0, 1, 0, 0, 0, 0}));
}

TEST(SceneState, SceneFreeHasZeroForce) {
  SceneState state(load_scene("free"), 3);
  EXPECT_EQ(state.answer(vector_of({0, 0, 0}), milliseconds{1}).force, vector_of({0, 0, 0}));
}

TEST(SceneState, TellsTheRipplesOfTheSurfaceTouchedInTheDevicesRows) {
  const auto scene = parse_scene(R"(
[scene]
name = "rippled"
description = ""
degrees_of_freedom = 3
[[object]]
name = "table"
shape = { kind = "half_space", through_m = [0, 0, 0], normal = [1, 0, 0] }
effects = ["surface", "texture"]
surface = { stiffness_N_per_m = 1000 }
texture = { amplitude_N = 0.5, wavelength_m = 0.002, direction = [0, 1, 0], pattern = "grid" }
)",
                                 "rippled.toml");
  const double wave_rad_per_m = 2 * std::numbers::pi / 0.002;
  const Answer on_it = SceneState(scene, 6).answer(vector_of({-0.001, 0, 0, 1, 2, 3}), milliseconds{1});
  EXPECT_EQ(on_it.texture_N, 0.5);
  EXPECT_EQ(on_it.texture_wave, vector_of({0, wave_rad_per_m, 0, 0, 0, 0}));
  EXPECT_EQ(on_it.texture_across, vector_of({0, 0, wave_rad_per_m, 0, 0, 0}));
  const Answer above = SceneState(scene, 3).answer(vector_of({0.001, 0, 0}), milliseconds{1});
  EXPECT_EQ(above.texture_N, 0);
  EXPECT_EQ(above.texture_wave.rows(), 0);
}

TEST(SceneState, AnObjectThatIsNotFiniteIsLeftOutAndNamedAndTheOthersGoOn) {
  const auto scene = parse_scene(R"(
[scene]
name = "two"
description = ""
degrees_of_freedom = 1
[[object]]
name = "far"
shape = { kind = "half_space", through_m = [0], normal = [-1] }
effects = ["surface"]
surface = { stiffness_N_per_m = 1e9, stiffening_N_per_m2 = 1e12 }
[[object]]
name = "near"
shape = { kind = "half_space", through_m = [1], normal = [-1] }
effects = ["surface"]
surface = { stiffness_N_per_m = 1000 }
)",
                                 "two.toml");
  SceneState state(scene, 1);
  const Answer answer = state.answer(vector_of({1e200}), milliseconds{1});
  ASSERT_EQ(state.quarantined().size(), 1U);
  EXPECT_EQ(*state.quarantined().front(), "far");
  EXPECT_EQ(answer.force, vector_of({-1e203}));
  const Answer next = state.answer(vector_of({1.001}), milliseconds{2});
  EXPECT_TRUE(state.quarantined().empty());
  EXPECT_NEAR(next.force[0], -1, 1e-9);
  EXPECT_EQ(state.faults().quarantined, 1U);
  SceneState other(scene, 1);
  EXPECT_LT(other.answer(vector_of({1.001}), milliseconds{2}).force[0], -1e6) << "another client has both";
}

TEST(SceneState, KeepsTheLastNormalThroughASpheresCentreAndCountsIt) {
  SceneState state(load_scene("sphere"), 3);
  (void)state.answer(vector_of({0, 0, 0.001}), milliseconds{1});
  const Answer answer = state.answer(vector_of({0, 0, 0}), milliseconds{2});
  EXPECT_EQ(answer.contact_normal, vector_of({0, 0, 1}));
  EXPECT_LT((answer.force - vector_of({0, 0, 200})).norm(), 1e-9);
  EXPECT_EQ(state.faults().old_normals, 1u);
}

TEST(SceneState, EstimatesVelocityFromDeviceTimes) {
  SceneState state(damped_plane(), 3);
  const Answer first = state.answer(vector_of({0, 0, -0.001}), milliseconds{10});
  EXPECT_NEAR(first.force[2], 1, 1e-12) << "the first motion has no velocity";
  // 1 mm deeper in 2 ms: 0.5 m/s, 5 N.
  EXPECT_NEAR(state.answer(vector_of({0, 0, -0.002}), milliseconds{12}).force[2], 7, 1e-9);
}

TEST(SceneState, TimeThatDoesNotAdvanceGivesNoVelocity) {
  SceneState state(damped_plane(), 3);
  (void)state.answer(vector_of({0, 0, -0.001}), milliseconds{10});
  EXPECT_NEAR(state.answer(vector_of({0, 0, -0.002}), milliseconds{10}).force[2], 2, 1e-12);
  EXPECT_NEAR(state.answer(vector_of({0, 0, -0.003}), milliseconds{5}).force[2], 3, 1e-12);
}

TEST(SceneState, TimesFurtherApartThan64BitsAreHarmless) {
  SceneState state(damped_plane(), 3);
  (void)state.answer(vector_of({0, 0, -0.001}), Nanoseconds::min());
  EXPECT_TRUE(state.answer(vector_of({0, 0, -0.002}), Nanoseconds::max()).force.allFinite());
}

TEST(SceneState, DeepestContactIsReportedAndForcesAdd) {
  const auto corner = parse_scene(R"(
[scene]
name = "corner"
description = ""
degrees_of_freedom = 2
[[object]]
name = "floor"
shape = { kind = "half_space", through_m = [0, 0], normal = [0, 1] }
effects = ["surface"]
surface = { stiffness_N_per_m = 1000 }
[[object]]
name = "side"
shape = { kind = "half_space", through_m = [0, 0], normal = [1, 0] }
effects = ["surface"]
surface = { stiffness_N_per_m = 3000 }
)",
                                  "corner.toml");
  SceneState state(corner, 2);
  const Answer answer = state.answer(vector_of({-0.001, -0.002}), milliseconds{1});
  EXPECT_LT((answer.force - vector_of({3, 2})).norm(), 1e-12);
  EXPECT_EQ(answer.contact_normal, vector_of({0, 1}));
  EXPECT_EQ(answer.penetration_m, 0.002);
}

TEST(SceneState, ForceThatIsNotFiniteIsZeroAndCounted) {
  SceneState state(load_scene("wall"), 1);
  const Answer answer = state.answer(vector_of({std::numeric_limits<double>::max()}), milliseconds{1});
  EXPECT_EQ(answer.force, vector_of({0}));
  EXPECT_EQ(answer.contact_normal.rows(), 0);
  EXPECT_EQ(state.faults().quarantined, 1u);
}

TEST(SceneState, AnswersAnyFiniteMotionWithFiniteForce) {
  const double huge = std::numeric_limits<double>::max();
  const std::vector<double> corners{0, 1e-300, -1e-300, 1e-9, 0.01, -0.01, 0.03, 1e6, -1e6, 1e300, -1e300, huge, -huge};
  for (const std::string name : {"plane", "sphere", "box"}) {
    SceneState state(load_scene(name), 3);
    std::int64_t time = 0;
    for (const double x : corners) {
      for (const double y : corners) {
        for (const double z : corners) {
          const Answer answer = state.answer(vector_of({x, y, z}), Nanoseconds{++time});
          ASSERT_TRUE(answer.force.allFinite() && answer.contact_normal.allFinite());
          ASSERT_TRUE(std::isfinite(answer.penetration_m));
        }
      }
    }
  }
}

TEST(SceneState, ClientsDoNotShareTheirMotion) {
  const auto scene = damped_plane();
  SceneState one(scene, 3);
  SceneState other(scene, 3);
  (void)one.answer(vector_of({0, 0, -0.001}), milliseconds{1});
  (void)other.answer(vector_of({0, 0, -0.5}), milliseconds{1});
  EXPECT_NEAR(one.answer(vector_of({0, 0, -0.001}), milliseconds{2}).force[2], 1, 1e-12);
}

}  // namespace
}  // namespace forcebound::scene
