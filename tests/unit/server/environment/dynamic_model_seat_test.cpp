#include "forcebound/scene/dynamic_model_seat.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/frail_model.hpp"

namespace forcebound::scene {
namespace {

using server::parse_scene;

using std::chrono::milliseconds;

std::shared_ptr<const Scene> table_with_ball(bool shared) {
  return parse_scene(std::string("[scene]\nname = \"table\"\ndescription = \"\"\ndegrees_of_freedom = 3\nshared = ") +
                         (shared ? "true\nclients_max = 2\n" : "false\n") +
                         "[bodies]\ngravity_m_per_s2 = [0, 0, 0]\n"
                         "[[body]]\nname = \"ball\"\nmass_kg = 0.1\n"
                         "shape = { kind = \"sphere\", center_m = [0, 0, 0], radius_m = 0.02 }\n",
                     "table.toml");
}

Vector at(double x) { return Vector{Eigen::Vector3d(x, 0, 0)}; }

/// Strokes from -40 mm towards the ball for so many milliseconds at 0.1 m/s.
double last_force_N(SceneState& state, int motions) {
  SceneAnswer answer;
  for (int i = 0; i < motions; ++i) answer = state.answer(at(-0.04 + 1e-4 * i), milliseconds(i), milliseconds(i));
  return answer.force[0];
}

TEST(SceneWithBodies, PushesBackTheHandThatPushesABall) {
  SceneState state(table_with_ball(false), 3);
  EXPECT_NEAR(last_force_N(state, 100), 0, 0.01) << "not yet there";
  SceneState pressing(table_with_ball(false), 3);
  EXPECT_LT(last_force_N(pressing, 190), -0.01);
}

TEST(SceneWithBodies, AnswersAreTheSameBitForBitForTheSameMotions) {
  const auto scene = table_with_ball(false);
  SceneState first(scene, 3);
  SceneState second(scene, 3);
  for (int i = 0; i < 500; ++i) {
    const SceneAnswer a = first.answer(at(-0.04 + 1e-4 * i), milliseconds(i));
    const SceneAnswer b = second.answer(at(-0.04 + 1e-4 * i), milliseconds(i), milliseconds(7 * i));
    ASSERT_EQ(a.force, b.force) << "the server's time must not matter";
  }
}

TEST(SceneWithBodies, LostMotionsLoseNoSimulatedTime) {
  const auto scene = table_with_ball(false);
  SceneState all(scene, 3);
  SceneState some(scene, 3);
  SceneAnswer a;
  SceneAnswer b;
  for (int i = 0; i <= 300; ++i) {
    a = all.answer(at(-0.04 + 1e-4 * i), milliseconds(i));
    if (i % 5 == 0) b = some.answer(at(-0.04 + 1e-4 * i), milliseconds(i));
  }
  EXPECT_NEAR(a.force[0], b.force[0], 0.02);
}

TEST(SharedScene, OneClientFeelsWhatTheOtherPushes) {
  const auto scene = table_with_ball(true);
  SceneState left(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState right(scene, 3, left.dynamic_models());
  // The right hand rests against the ball's other side, the left one comes and pushes the ball at it.
  double right_N = 0;
  for (int i = 0; i < 300; ++i) {
    (void)left.answer(at(-0.04 + std::min(1e-4 * i, 0.025)), milliseconds(i), milliseconds(i));
    right_N = right.answer(at(0.023), milliseconds(i), milliseconds(i)).force[0];
  }
  EXPECT_GT(right_N, 0.05);

  SceneState alone(table_with_ball(false), 3);
  double alone_N = 1;
  for (int i = 0; i < 300; ++i) alone_N = alone.answer(at(0.0245), milliseconds(i)).force[0];
  EXPECT_NEAR(alone_N, 0, 1e-6);
}

TEST(SharedScene, TimeGoesOnceHoweverManyClientsThereAre) {
  const auto scene = table_with_ball(true);
  SceneState one(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState two_left(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState two_right(scene, 3, two_left.dynamic_models());
  for (int i = 0; i < 190; ++i) {
    const double x = -0.04 + 1e-4 * i;
    const SceneAnswer a = one.answer(at(x), milliseconds(i), milliseconds(i));
    const SceneAnswer b = two_left.answer(at(x), milliseconds(i), milliseconds(i));
    (void)two_right.answer(at(0.3), milliseconds(i), milliseconds(i));
    ASSERT_NEAR(a.force[0], b.force[0], 1e-6);
  }
}

TEST(SharedScene, ASeatIsFreeAgainWhenItsClientLeaves) {
  const auto scene = table_with_ball(true);
  SceneState stays(scene, 3, begin_dynamic_models(*scene, 2));
  { SceneState leaves(scene, 3, stays.dynamic_models()); }
  SceneState comes(scene, 3, stays.dynamic_models());
  EXPECT_THROW(SceneState(scene, 3, stays.dynamic_models()), std::logic_error);
}

TEST(SharedScene, InvalidMotionsOfAnUntrustedClientDoNotAffectTheOthers) {
  const auto scene = table_with_ball(true);
  SceneState honest(scene, 3, begin_dynamic_models(*scene, 2));
  SceneState untrusted(scene, 3, honest.dynamic_models());
  for (int i = 0; i < 500; ++i) {
    const double wild = (i % 2 == 0 ? 1 : -1) * std::numeric_limits<double>::max();
    (void)untrusted.answer(at(wild), milliseconds(i % 3), milliseconds(i));
    const SceneAnswer answer = honest.answer(at(-0.03), milliseconds(i), milliseconds(i));
    ASSERT_TRUE(answer.force.allFinite());
    ASSERT_TRUE(answer.quarantined.empty());
  }
}

TEST(SceneState, QuarantinesADynamicModelByNameAndTheOthersGoOn) {
  SceneState state(test::frail_scene({.name = "s", .description = ""}, {"frail"}), 3);
  for (int i = 0; i < 6; ++i) {
    const SceneAnswer answer = state.answer(at(0), milliseconds(i));
    EXPECT_EQ(answer.force[2], i < 3 ? 1 : 0) << i;
    EXPECT_EQ(answer.quarantined.empty() ? "" : *answer.quarantined.front(), i == 3 ? "frail" : "") << i;
  }
  EXPECT_EQ(state.faults().quarantined, 1U);
}

TEST(SceneState, NamesAllThatAreQuarantinedOnOneMotion) {
  SceneState state(test::frail_scene({.name = "s", .description = ""}, {"first", "second"}), 3);
  std::vector<std::string> names;
  for (int i = 0; i < 6; ++i) {
    for (const std::string* name : state.answer(at(0), milliseconds(i)).quarantined) names.push_back(*name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"first", "second"}));
  EXPECT_EQ(state.faults().quarantined, 2U);
}

TEST(SceneWithBodies, DoesNotAllocate) {
  SceneState state(table_with_ball(false), 3);
  (void)last_force_N(state, 10);
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  (void)last_force_N(state, 200);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::scene
