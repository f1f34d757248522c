#include "forcebound/scene/plan.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "forcebound/scene/scene_state.hpp"
#include "tests/support/own_effects.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::scene {
namespace {

using std::chrono::milliseconds;
using test::scene_with_own_effects;
using test::table;
using test::vector_of;

/// A client that moves up and down, a motion every millisecond.
class Client {
 public:
  explicit Client(const std::shared_ptr<const Scene>& scene) : state_(scene, 3) {}
  Vector at(double z_m) { return state_.answer(vector_of({0, 0, z_m}), milliseconds{++now_}).force; }
  SceneState& state() { return state_; }

 private:
  SceneState state_;
  int now_ = 0;
};

TEST(Plan, ContainsOnlyRequestedEffects) {
  const auto scene = scene_with_own_effects(table("table", "'surface'"));
  EXPECT_EQ(scene->plan().effects().size(), 1U);
  EXPECT_EQ(scene->plan().state_bytes(), 0U);
  EXPECT_FALSE(scene->plan().inputs().time);
  EXPECT_FALSE(scene->plan().inputs().pressure);
}

TEST(Plan, PutsEffectsThatNeedPressureAfterThoseThatMakeIt) {
  Client client(scene_with_own_effects(table("table", "'pressed', 'surface'")));
  EXPECT_NEAR(client.at(-0.002)[0], 2, 1e-12);
}

TEST(Plan, ForgetsContactWhenItIsLost) {
  Client client(scene_with_own_effects(table("table", "'surface', 'pressed'")));
  EXPECT_EQ(client.at(-0.001)[1], 0);
  EXPECT_EQ(client.at(-0.001)[1], 1);
  EXPECT_EQ(client.at(0.001)[1], 0) << "no contact, no effect";
  EXPECT_EQ(client.at(-0.001)[1], 0) << "counts anew";
}

TEST(Plan, ActsAboveTheSurfaceOnlyWithinReachAndRemembersThere) {
  Client client(scene_with_own_effects(table("table", "'near'")));
  EXPECT_EQ(client.at(0.011), vector_of({0, 0, 0}));
  EXPECT_EQ(client.at(0.009), vector_of({1, 0, 0}));
  EXPECT_EQ(client.at(-0.001), vector_of({1, 1, 0}));
  EXPECT_EQ(client.at(0.009), vector_of({1, 2, 0}));
  EXPECT_EQ(client.at(0.011), vector_of({0, 0, 0}));
  EXPECT_EQ(client.at(0.009), vector_of({1, 0, 0})) << "counts anew";
}

TEST(Plan, FieldsActEverywhereWithTheTimeOfTheDevice) {
  Client client(scene_with_own_effects("[[field]]\nname = 'fog'\neffects = ['clock']\n"));
  EXPECT_EQ(client.at(5), vector_of({1, 0, 0})) << "no time has passed on the first motion";
  EXPECT_EQ(client.at(-5), vector_of({2, 1e-3, 1e-3}));
  EXPECT_EQ(client.at(0), vector_of({3, 2e-3, 1e-3}));
}

TEST(Plan, EffectsOfSpaceWithinAnObjectActOnlyThere) {
  Client client(scene_with_own_effects(table("pool", "'clock'")));
  EXPECT_EQ(client.at(0.001)[0], 0);
  EXPECT_EQ(client.at(-0.001)[0], 1);
}

TEST(Plan, SaysOfTheForceWhichPartFadesWithoutAServerAsItsEffectStates) {
  const auto scene =
      scene_with_own_effects(table("table", "'surface'") + "[[field]]\nname = 'x'\neffects = ['lever']\n");
  SceneState state(scene, 3);
  const Answer answer = state.answer(vector_of({0, 0, -0.001}), milliseconds{1});
  EXPECT_NEAR((answer.force - vector_of({1, 0, 0})).norm(), 0, 1e-12) << "1 N out of the table, 1 N into it";
  EXPECT_NEAR((answer.fading_N - vector_of({1, 0, -1})).norm(), 0, 1e-12);
}

TEST(Plan, EachClientHasAStateOfItsOwn) {
  const auto scene = scene_with_own_effects("[[field]]\nname = 'fog'\neffects = ['clock']\n");
  Client one(scene);
  Client other(scene);
  (void)one.at(0);
  EXPECT_EQ(one.at(0)[0], 2);
  EXPECT_EQ(other.at(0)[0], 1);
}

}  // namespace
}  // namespace forcebound::scene
