#include "forcebound/server/dynamics/bodies/body_mobility.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/body_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/dynamics/bodies/hand.hpp"

namespace forcebound::server {
namespace {

constexpr double kBall_kg = 0.03;  // as ProbeDescription presets it
constexpr double kCube_kg = 0.1;

/// Bodies without weight, so that nothing but the hand moves them.
BodiesDescription weightless(std::vector<BodyDescription> bodies) {
  return {.bodies = std::move(bodies), .gravity_m_per_s2 = scene::Point::Zero()};
}

BodyDescription wall_at(double x_m) {
  return {.name = "wall", .size_m = {0.1, 1, 1}, .mass_kg = 0, .position_m = {x_m + 0.05, 0, 0}};
}

/// A hand among bodies, and what it is told about the ball that it drags.
class DescribedBody : public ::testing::Test {
 protected:
  void begin(BodiesDescription description, const scene::Point& at_m) {
    bodies = std::make_unique<BodyDynamicModel>(std::move(description), "test");
    state = bodies->make_state(1);
    hand = std::make_unique<Hand>(*state);
    (void)hand->rest_at(at_m, 600);  // until the coupling has reached the device
  }

  /// A peg on an oblique rail, 45 degrees between x and y, among geoms.
  void begin_on_rail(const std::string& geoms, const scene::Point& at_m) {
    bodies = std::make_unique<BodyDynamicModel>(
        compile_mjcf("<mujoco><option timestep='0.001' gravity='0 0 0'/><worldbody>" + geoms +
                         "<body name='peg'><joint type='slide' axis='1 1 0'/><geom size='0.005' mass='0.1'/></body>"
                         "</worldbody></mujoco>",
                     "peg.xml"),
        std::vector<std::string>{"peg"}, Coupling{}, "peg.xml");
    state = bodies->make_state(1);
    hand = std::make_unique<Hand>(*state);
    (void)hand->rest_at(at_m, 600);
  }

  [[nodiscard]] local_model::Mass described() {
    local_model::LocalModel told;
    EXPECT_TRUE(state->describe(0, told));
    EXPECT_TRUE(told.has_mass);
    EXPECT_TRUE(local_model::is_sound(told));
    return told.mass;
  }

  [[nodiscard]] scene::Point ball_m() const {
    const auto& world = dynamic_cast<const BodyWorld&>(*state);
    const int ball = mj_name2id(&world.model(), mjOBJ_BODY, "probe 0");
    // Its joints begin at the origin. What MuJoCo says of bodies is of the step's beginning.
    return Eigen::Map<const scene::Point>(world.data().qpos +
                                          world.model().jnt_qposadr[world.model().body_jntadr[ball]]);
  }

  std::unique_ptr<BodyDynamicModel> bodies;
  std::unique_ptr<scene::DynamicModelState> state;
  std::unique_ptr<Hand> hand;
};

/// Where the law of a local model takes its mass while the device goes straight from one place to another, in steps of
/// a millisecond, as a client and these bodies have them.
scene::Point predicted_m(const local_model::Mass& mass, const scene::Point& from_m, const scene::Point& to_m,
                         int milliseconds) {
  constexpr double kStep_s = 1e-3;
  const scene::Point device_m_per_s = (to_m - from_m) / (milliseconds * kStep_s);
  scene::Point place_m = mass.place_m;
  scene::Point velocity = mass.velocity_m_per_s;
  for (int i = 1; i <= milliseconds; ++i) {
    const scene::Point device_m = from_m + i * kStep_s * device_m_per_s;
    const scene::Point force_N =
        mass.stiffness_N_per_m * (device_m - place_m) + mass.damping_N_s_per_m * (device_m_per_s - velocity);
    velocity += kStep_s * (mass.bias_m_per_s2 + mass.mobility_per_kg * force_N);
    place_m += kStep_s * velocity;
  }
  return place_m;
}

TEST_F(DescribedBody, InTheAirIsTheBallAlone) {
  begin(weightless({wall_at(0.5)}), {0, 0, 0});
  const local_model::Mass told = described();
  EXPECT_TRUE(told.mobility_per_kg.isApprox(Eigen::Matrix3d::Identity() / kBall_kg, 1e-6));
  EXPECT_EQ(told.stiffness_N_per_m, Coupling{}.stiffness_N_per_m);
  EXPECT_EQ(told.damping_N_s_per_m, Coupling{}.damping_N_s_per_m);
  EXPECT_LT(told.bias_m_per_s2.norm(), 1e-6);
  const scene::Point begin_m = ball_m();
  const scene::Point to_m(0.0008, 0.0006, 0);
  const scene::Point foretold_m = predicted_m(told, {0, 0, 0}, to_m, 10);
  (void)hand->along({0, 0, 0}, to_m);
  EXPECT_LT((ball_m() - foretold_m).norm(), 0.01 * (foretold_m - begin_m).norm());
}

TEST_F(DescribedBody, IsNotToldWhereItsCouplingIsStableInShorterStepsThanAClients) {
  BodiesDescription stiff = weightless({wall_at(0.5)});
  stiff.timestep_s = 1e-4;
  stiff.coupling = {.stiffness_N_per_m = 30'000, .damping_N_s_per_m = 50};
  begin(std::move(stiff), {0, 0, 0});
  local_model::LocalModel told;
  EXPECT_FALSE(state->describe(0, told));
  EXPECT_TRUE(told.empty());
}

TEST_F(DescribedBody, IsConstrainedByWhatItPressesAgainstAndByNothingInTheAir) {
  begin(weightless({wall_at(0.03)}), {0, 0, 0});
  const auto& world = dynamic_cast<const BodyWorld&>(*state);
  EXPECT_FALSE(BodyMobility::is_constrained(world.data()));
  EXPECT_EQ(described().mobility_per_kg, described().free_per_kg);
  (void)hand->along({0, 0, 0}, {0.04, 0, 0});
  (void)hand->rest_at({0.04, 0, 0}, 100);
  EXPECT_TRUE(BodyMobility::is_constrained(world.data()));
}

TEST_F(DescribedBody, IsWhereItIsNowThoughItsLastStepEndedBefore) {
  BodiesDescription slow = weightless({wall_at(0.5)});
  slow.timestep_s = 2e-3;
  begin(std::move(slow), {0, 0, 0});
  (void)hand->along({0, 0, 0}, {0.05, 0, 0});  // at 0.1 m/s, until the ball follows as fast
  local_model::Mass before = described();
  for (int i = 1; i <= 4; ++i) {
    (void)hand->to({0.05 + 1e-4 * i, 0, 0});
    const local_model::Mass told = described();
    EXPECT_NEAR(told.place_m.x() - before.place_m.x(), 1e-4, 1e-6);
    EXPECT_NEAR(told.travel_m - before.travel_m, -1e-4, 1e-6);
    before = told;
  }
}

TEST_F(DescribedBody, WithACubeBeforeItHasTheMassOfBoth) {
  begin(weightless({cube(kCube_kg, {0, 0, 0})}), {-0.03, 0, 0});
  // Pushes through the cube's centre, 25 ms long; twice that, and the cube would be faster than the hand.
  (void)hand->along({-0.03, 0, 0}, {-0.0215, 0, 0});
  const local_model::Mass told = described();
  ASSERT_GT(told.push.x(), 0.99);
  EXPECT_NEAR(told.mobility_per_kg(0, 0) * (kBall_kg + kCube_kg), 1, 0.05);
  EXPECT_TRUE(told.free_per_kg.isApprox(Eigen::Matrix3d::Identity() / kBall_kg, 1e-6)) << "what leaves with the hand";
  EXPECT_EQ(told.travel_m, std::numeric_limits<double>::infinity());
  const scene::Point begin_m = ball_m();
  const scene::Point foretold_m = predicted_m(told, {-0.0215, 0, 0}, {-0.0205, 0, 0}, 10);
  (void)hand->along({-0.0215, 0, 0}, {-0.0205, 0, 0});
  EXPECT_NEAR(ball_m().x(), foretold_m.x(), 0.15 * (foretold_m - begin_m).norm());
}

TEST_F(DescribedBody, AgainstAWallGoesNoFartherAndLeavesByItsOwnMass) {
  begin(weightless({wall_at(0)}), {-0.01, 0, 0});
  (void)hand->along({-0.01, 0, 0}, {0.002, 0, 0});
  (void)hand->rest_at({0.002, 0, 0}, 300);
  const local_model::Mass told = described();
  ASSERT_GT(told.push.x(), 0.99);
  EXPECT_EQ(told.travel_m, 0);
  EXPECT_NEAR(told.mobility_per_kg(0, 0) * kBall_kg, 1, 1e-6);
  EXPECT_NEAR(told.bias_m_per_s2.x(), 0, 1e-9);
}

TEST_F(DescribedBody, SaysHowFarACubeGoesBeforeAWall) {
  begin(weightless({cube(kCube_kg, {0, 0, 0}), wall_at(0.06)}), {-0.03, 0, 0});
  (void)hand->along({-0.03, 0, 0}, {-0.0215, 0, 0});
  const local_model::Mass told = described();
  ASSERT_GT(told.push.x(), 0.99);
  const double cube_m = ball_m().x() + 0.004 + 0.02;  // its middle
  EXPECT_NEAR(told.travel_m, 0.06 - 0.02 - cube_m, 5e-4);
}

TEST_F(DescribedBody, InTheAirKnowsWhatItWouldMeetFirstThoughItGoesElsewhere) {
  begin(weightless({wall_at(0.03)}), {0, 0, 0});
  (void)hand->along({0, 0, 0}, {-0.005, 0, 0});
  const local_model::Mass told = described();
  EXPECT_EQ(told.push, scene::Point(scene::Point::UnitX()));
  EXPECT_NEAR(told.travel_m, 0.03 - 0.004 - ball_m().x(), 1e-6);
}

constexpr const char* kWallAt3Centimetres = "<geom type='box' size='0.05 1 1' pos='0.08 0 0'/>";

Eigen::Matrix3d rail_per_kg() {
  const scene::Point rail = scene::Point(1, 1, 0).normalized();
  return rail * rail.transpose() / 0.1;
}

TEST_F(DescribedBody, OnARailInTheAirKnowsWhatItWouldMeetWhereItsJointLetsItGo) {
  begin_on_rail(std::string(kWallAt3Centimetres) + "<geom type='box' size='1 1 0.05' pos='0 0 -0.056'/>", {0, 0, 0});
  const local_model::Mass told = described();
  EXPECT_EQ(told.push, scene::Point(scene::Point::UnitX())) << "not the floor a millimetre below";
  EXPECT_NEAR(told.travel_m, 0.025, 1e-6);
  EXPECT_TRUE(told.mobility_per_kg.isApprox(rail_per_kg(), 1e-6));
  EXPECT_EQ(told.free_per_kg, told.mobility_per_kg);
}

TEST_F(DescribedBody, OnARailAgainstAWallLeavesItAlongTheRail) {
  begin_on_rail(kWallAt3Centimetres, {0, 0, 0});
  (void)hand->along({0, 0, 0}, {0.027, 0.027, 0});
  (void)hand->rest_at({0.027, 0.027, 0}, 300);
  const local_model::Mass told = described();
  ASSERT_GT(told.push.x(), 0.99);
  EXPECT_EQ(told.travel_m, 0);
  EXPECT_TRUE(told.mobility_per_kg.isApprox(rail_per_kg(), 1e-3));
  EXPECT_TRUE(told.free_per_kg.isApprox(rail_per_kg(), 1e-6));
}

TEST_F(DescribedBody, IsNotThereBeforeTheCouplingHasReachedTheDevice) {
  const BodyDynamicModel soon({.bodies = {floor_plate()}}, "test");
  const auto begun = soon.make_state(1);
  (void)Hand(*begun).rest_at({0, 0, 0.1}, 100);
  local_model::LocalModel none;
  EXPECT_FALSE(begun->describe(0, none));
  EXPECT_TRUE(none.empty());
  EXPECT_TRUE(soon.facts().describes_itself);
}

TEST_F(DescribedBody, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  begin(weightless({cube(kCube_kg, {0, 0, 0}), wall_at(0.06)}), {-0.03, 0, 0});
  (void)hand->along({-0.03, 0, 0}, {-0.0215, 0, 0});
  local_model::LocalModel told;
  const test::AllocationGuard guard;
  EXPECT_TRUE(state->describe(0, told));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
