#include "tests/tools/lab/accuracy/body_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "forcebound/time/steady_clock.hpp"
#include "tests/unit/tools/lab/accuracy/body_scenes.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

Along run(const std::string& bodies, const std::vector<Vector>& positions_m) {
  return run_along(stack(bodies), positions_m, time::SteadyClock());
}

TEST(BodyWatch, FindsNoEnergyThatTheDeviceDidNotPutIn) {
  for (const char* const step_s : {"0.002", "0.001", "0.0005"}) {
    SCOPED_TRACE(step_s);
    const auto bodies = run("timestep_s = " + std::string(step_s), pressing(400)).bodies;
    ASSERT_TRUE(bodies);
    EXPECT_GT(bodies->turned_over_J, 1e-3);
    EXPECT_LT(bodies->gained_J, 0.02 * bodies->turned_over_J);
    EXPECT_LT(bodies->drift_J, 0);
    EXPECT_EQ(body_trouble(*bodies, *bodies), "");
  }
}

TEST(BodyWatch, CountsOnlyTicksOnWhichBodiesStepped) {
  EXPECT_EQ(run("timestep_s = 0.002", pressing(101)).bodies->ticks, 50);
  EXPECT_EQ(run("timestep_s = 0.0005", pressing(101)).bodies->ticks, 100);
}

TEST(BodyWatch, SeesNothingInASceneWithoutBodies) {
  const auto scene =
      server::parse_scene("[scene]\nname = 'none'\ndescription = ''\ndegrees_of_freedom = 3\n", "n.toml");
  scene::SceneState state(scene, 3);
  BodyWatch watch(state);
  EXPECT_FALSE(watch.any());
  EXPECT_TRUE(watch.observe());
}

TEST(BodyWatch, TellsASolverThatUsesAllItsIterationsFromOneThatNeedsFewer) {
  const auto few = run("solver = 'pgs'\niterations = 2\ntolerance = 0", pressing(200)).bodies;
  EXPECT_EQ(few->exhausted, few->ticks);
  EXPECT_EQ(run("", pressing(200)).bodies->exhausted, 0);
}

TEST(BodyTrouble, SaysThatAStackCollapsed) {
  const BodyRecord standing = *run("", pressing(300)).bodies;
  BodyRecord fallen = standing;
  fallen.places[2].center_m.z() -= 0.04;
  EXPECT_EQ(body_trouble(fallen, standing), "'high' fell by 40 mm");
  EXPECT_EQ(body_trouble(fallen, standing, false), "") << "the reference does not know either";
  fallen = standing;
  fallen.places[1].up = scene::Point::UnitX();
  EXPECT_THAT(body_trouble(fallen, standing), HasSubstr("'middle' fell over, by "));
  fallen = standing;
  fallen.places[0].center_m.x() += 0.2;
  EXPECT_EQ(body_trouble(fallen, standing), "'low' left its place by 200 mm");
}

TEST(BodyTrouble, SaysWhatBrokeAnInvariant) {
  const BodyRecord good = *run("", pressing(300)).bodies;
  BodyRecord bad = good;
  bad.gained_J = 0.05 * good.turned_over_J + 0.01 * good.weight_J + 0.001;
  EXPECT_THAT(body_trouble(bad, good), HasSubstr(" mJ of energy from nowhere"));
  bad.is_driven = true;
  EXPECT_EQ(body_trouble(bad, good), "") << "an actuator may add energy";
  bad = good;
  bad.deepest_m = 3 * good.deepest_m + 0.001;
  EXPECT_THAT(body_trouble(bad, good), HasSubstr("within each other, in the reference "));
  bad = good;
  bad.deepest_of_thickness = 1.1;
  EXPECT_THAT(body_trouble(bad, bad), HasSubstr("half through the thinner one"));
  bad = good;
  bad.warnings["Inertia matrix is too close to singular"] = 3;
  EXPECT_EQ(body_trouble(bad, good), "MuJoCo warned 3 times: Inertia matrix is too close to singular");
}

TEST(BodyTrouble, FindsARunThatDidCollapse) {
  // One iteration cannot carry the stack.
  const Along good = run("", pressing(500));
  const Along bad = run("solver = 'cg'\niterations = 1", pressing(500));
  EXPECT_NE(body_trouble(*bad.bodies, *good.bodies), "");
}

}  // namespace
}  // namespace forcebound::lab
