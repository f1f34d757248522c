#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <cmath>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/body_world.hpp"

namespace forcebound::server {
namespace {

BodyDescription floor_plate() {
  return {.name = "floor", .size_m = {1, 1, 0.1}, .mass_kg = 0, .position_m = {0, 0, -0.05}};
}

BodyDescription cube(const std::string& name, double mass_kg, const scene::Point& position_m) {
  return {.name = name, .size_m = {0.04, 0.04, 0.04}, .mass_kg = mass_kg, .position_m = position_m};
}

std::unique_ptr<scene::DynamicModelState> world_of(std::vector<BodyDescription> bodies) {
  return BodyDynamicModel({.bodies = std::move(bodies)}, "test").make_state(1);
}

const BodyWorld& world(const scene::DynamicModelState& state) { return dynamic_cast<const BodyWorld&>(state); }

double kinetic_J(const BodyWorld& bodies) {
  const mjModel_& model = bodies.model();
  std::vector<double> momentum(static_cast<std::size_t>(model.nv));
  mj_mulM(&model, &bodies.data(), momentum.data(), bodies.data().qvel);
  return 0.5 * mju_dot(momentum.data(), bodies.data().qvel, model.nv);
}

double energy_J(const BodyWorld& bodies) {
  const mjModel_& model = bodies.model();
  double potential_J = 0;
  for (int i = 1; i < model.nbody; ++i) {
    potential_J -= model.body_mass[i] * mju_dot3(model.opt.gravity, bodies.data().xipos + 3 * i);
  }
  return kinetic_J(bodies) + potential_J;
}

TEST(HardCase31, MoreContactsThanMuJoCoWasGivenRoomForAreCountedAndNothingBreaks) {
  // A box on a plate has four contacts; here is room for two, so that it tilts.
  const BodyDynamicModel dynamic_model(compile_mjcf(R"(<mujoco><size nconmax="2" njmax="100"/><worldbody>
      <geom type="box" size="1 1 0.05" pos="0 0 -0.05"/>
      <body name="box" pos="0 0 0.02"><freejoint/><geom type="box" size="0.02 0.02 0.02" mass="0.1"/></body>
    </worldbody></mujoco>)",
                                                    "box.xml"),
                                       {"box"}, {.stiffness_N_per_m = 100, .damping_N_s_per_m = 1}, "box.xml");
  const auto state = dynamic_model.make_state(1);
  const int seat = state->join();
  for (int i = 0; i < 1000; ++i) {
    state->move(seat, {0, 0, 0.02}, scene::Point::Zero());
    state->advance(1e-3);
    ASSERT_TRUE(state->touch(seat).force_N.allFinite());
  }
  EXPECT_TRUE(state->sound());
  EXPECT_GT(state->faults().contacts_left_out, 0U);
}

TEST(HardCase32, ACouplingAtTwiceItsStableStepIsRefusedWithTheNumbers) {
  BodiesDescription stiff{.bodies = {floor_plate()}};
  // h omega = 2: sqrt(4e4 / 0.01) 1e-3.
  stiff.probe.mass_kg = 0.01;
  stiff.coupling = {.stiffness_N_per_m = 4e4, .damping_N_s_per_m = 0};
  EXPECT_THROW(BodyDynamicModel(stiff, "test"), BodiesError);
  stiff.timestep_s = 0.9e-3;
  // If accepted it rings, at 1 / sqrt(1 - 0.9^2) of its initial amplitude, and does not grow.
  const auto state = BodyDynamicModel(stiff, "test").make_state(1);
  const int seat = state->join();
  state->move(seat, {0, 0, 0.1}, scene::Point::Zero());
  for (int i = 0; i < 5000; ++i) {
    state->move(seat, {1e-3, 0, 0.1}, scene::Point::Zero());
    state->advance(stiff.timestep_s);
    ASSERT_LT(state->touch(seat).force_N.norm(), 1.01 * 4e4 * 1e-3 * 2.3) << "step " << i;
  }
}

TEST(HardCase33, MassRatiosOfAThousandToAMillionComeToRest) {
  for (const double ratio : {1e3, 1e4, 1e5, 1e6}) {
    const auto state =
        world_of({floor_plate(), cube("light", 1e-3, {0, 0, 0.02}), cube("heavy", 1e-3 * ratio, {0, 0, 0.06})});
    for (int i = 0; i < 3000; ++i) state->advance(1e-3);
    ASSERT_TRUE(state->sound()) << ratio;
    const BodyWorld& bodies = world(*state);
    const double* heavy_m = bodies.data().xpos + 3 * mj_name2id(&bodies.model(), mjOBJ_BODY, "heavy");
    EXPECT_GT(heavy_m[2], 0.0) << ratio << ": not through the floor";
    EXPECT_LT(heavy_m[2], 0.065) << ratio << ": not thrown up";
    for (int i = 0; i < bodies.model().nv; ++i) EXPECT_LT(std::abs(bodies.data().qvel[i]), 0.05) << ratio;
  }
}

TEST(HardCase34, ContactMadeAndBrokenWithinAStepGivesNoEnergy) {
  // 1 to 10 m/s: up to a quarter of its size in a step.
  for (const double speed_m_per_s : {1.0, 2.0, 4.0, 6.0, 10.0}) {
    const auto state = world_of({floor_plate(), cube("cube", 0.1, {0, 0, 0.05})});
    auto& bodies = dynamic_cast<BodyWorld&>(*state);
    bodies.data().qvel[2] = -speed_m_per_s;
    const double before_J = energy_J(bodies);
    for (int i = 0; i < 300; ++i) {
      state->advance(1e-3);
      // MuJoCo does not report the energy stored in contacts: the energy of the bodies alone may not exceed the initial
      // one.
      ASSERT_LE(energy_J(bodies), before_J * (1 + 1e-3)) << speed_m_per_s << " m/s, step " << i;
    }
  }
}

void expect_unit_quaternion_after(int steps) {
  // Without gravity: after a day of free fall the positions of body and probe would overflow.
  const auto state =
      BodyDynamicModel({.bodies = {cube("cube", 0.1, {0, 0, 0})}, .gravity_m_per_s2 = scene::Point::Zero()}, "test")
          .make_state(1);
  auto& bodies = dynamic_cast<BodyWorld&>(*state);
  bodies.data().qvel[3] = 3;
  bodies.data().qvel[4] = -7;
  bodies.data().qvel[5] = 11;
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(step(bodies.model(), bodies.data()));
  const Eigen::Map<const Eigen::Vector4d> quaternion(bodies.data().qpos + 3);
  EXPECT_LT(std::abs(quaternion.norm() - 1), 1e-12);
}

TEST(HardCase35, AQuaternionStaysOne) { expect_unit_quaternion_after(FORCEBOUND_QUATERNION_STEPS); }

TEST(HardCase35, NoAndTinyRotationsStayWhatTheyAre) {
  for (const double turn_rad_per_s : {0.0, 1e-300, 1e-160, 1e-20, 1e-8}) {
    const auto state = world_of({cube("cube", 0.1, {0, 0, 0})});
    auto& bodies = dynamic_cast<BodyWorld&>(*state);
    bodies.data().qvel[4] = turn_rad_per_s;
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(step(bodies.model(), bodies.data()));
    // After a second the half angle; MuJoCo passes over less than 1e-15 rad a step.
    EXPECT_NEAR(bodies.data().qpos[5], turn_rad_per_s / 2, 1e-12 + 1e-6 * turn_rad_per_s);
    EXPECT_NEAR(bodies.data().qpos[3], 1, 1e-12);
  }
}

TEST(HardCase39, BodiesThatAreNotFiniteAreReported) {
  const auto state = world_of({floor_plate(), cube("cube", 0.1, {0, 0, 0.02})});
  auto& bodies = dynamic_cast<BodyWorld&>(*state);
  bodies.data().qpos[1] = std::nan("");
  state->advance(1e-3);
  EXPECT_FALSE(state->sound());
}

TEST(HardCase40, DegenerateInertiasAreRefused) {
  const auto refused = [](const std::string& inertial) {
    try {
      (void)compile_mjcf("<mujoco><worldbody><body name='b'><freejoint/><inertial pos='0 0 0' " + inertial +
                             "/><geom size='0.1'/></body></worldbody></mujoco>",
                         "inertia.xml");
      return std::string("accepted");
    } catch (const BodiesError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refused("mass='1' diaginertia='1 1 1'"), "accepted");
  for (const char* inertial : {"mass='0' diaginertia='1 1 1'", "mass='1' diaginertia='0 0 0'",
                               "mass='1' diaginertia='1 1 3'", "mass='-1' diaginertia='1 1 1'"}) {
    EXPECT_EQ(refused(inertial).rfind("inertia.xml: ", 0), 0U) << inertial << ": " << refused(inertial);
  }
  EXPECT_THROW(world_of({{.name = "dust", .size_m = {1e-4, 1e-4, 1e-4}, .mass_kg = 1e-9}}), BodiesError);
}

TEST(HardCase41, TumblingAboutTheMiddleAxisStaysBounded) {
  // A block of three different inertias, turned about the middle one: it flips over and over.
  const BodyDynamicModel dynamic_model({.bodies = {{.name = "block", .size_m = {0.08, 0.04, 0.01}, .mass_kg = 0.1}},
                                        .gravity_m_per_s2 = scene::Point::Zero()},
                                       "test");
  const auto state = dynamic_model.make_state(1);
  auto& bodies = dynamic_cast<BodyWorld&>(*state);
  bodies.data().qvel[3] = 0.01;
  bodies.data().qvel[4] = 20;
  bodies.data().qvel[5] = 0.01;
  const double before_J = kinetic_J(bodies);
  double most_J = 0;
  bool flipped = false;
  for (int i = 0; i < 60000; ++i) {
    ASSERT_TRUE(step(bodies.model(), bodies.data()));
    most_J = std::max(most_J, kinetic_J(bodies));
    flipped = flipped || bodies.data().qvel[4] < -5;
  }
  EXPECT_TRUE(flipped);
  EXPECT_GT(before_J, 1e-4);
  EXPECT_LT(most_J, before_J * 1.01);
}

}  // namespace
}  // namespace forcebound::server
