#include "forcebound/server/dynamics/bodies/body_world.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "tests/unit/server/dynamics/bodies/hand.hpp"

namespace forcebound::server {
namespace {

std::unique_ptr<BodyWorld> world_of(const std::string& mjcf, const std::string& probe, const Coupling& coupling) {
  ModelPointer model = compile_mjcf("<mujoco>" + mjcf + "</mujoco>", "test.xml");
  const int body = mj_name2id(model.get(), mjOBJ_BODY, probe.c_str());
  return std::make_unique<BodyWorld>(std::move(model), coupling, std::vector<BodyWorld::Probe>{{.body = body}});
}

BodyWorld& world(scene::DynamicModelState& state) { return dynamic_cast<BodyWorld&>(state); }

scene::Point center_of_mass_m(BodyWorld& bodies, const char* name) {
  // Brought up to date: a step leaves it where the step began.
  mj_kinematics(&bodies.model(), &bodies.data());
  return Eigen::Map<const scene::Point>(bodies.data().xipos + 3 * mj_name2id(&bodies.model(), mjOBJ_BODY, name));
}

double kinetic_J(BodyWorld& bodies) {
  mj_kinematics(&bodies.model(), &bodies.data());
  mj_comPos(&bodies.model(), &bodies.data());
  mj_crb(&bodies.model(), &bodies.data());
  std::vector<double> momentum(static_cast<std::size_t>(bodies.model().nv));
  mj_mulM(&bodies.model(), &bodies.data(), momentum.data(), bodies.data().qvel);
  return 0.5 * mju_dot(momentum.data(), bodies.data().qvel, bodies.model().nv);
}

/// What a device has put into its coupling, and what coupling and bodies could give back.
struct Ledger {
  double into_J = 0;
  double stored_J = 0;
  double most_stored_J = 0;
  double least_margin_J = 0;  ///< of what went in above what is stored
};

/// A device that begins at the center of mass of an arm on a hinge, goes through the hinge to the other side and back
/// at 1 m/s, and then once around at that speed, four times slower than the arm's own swing on the coupling.
Ledger drag_an_arm_around(double timestep_s) {
  constexpr double kArm_m = 0.08;
  const Coupling coupling{.stiffness_N_per_m = 200, .damping_N_s_per_m = 1};
  const auto bodies = world_of("<option gravity='0 0 0' timestep='" + std::to_string(timestep_s) +
                                   "'/><worldbody><body name='arm'><joint axis='0 0 1'/><inertial pos='0.08 0 0' "
                                   "mass='0.2' diaginertia='2e-4 2e-4 2e-4'/></body></worldbody>",
                               "arm", coupling);
  const int seat = bodies->join();
  const auto path_m = [&](double time_s) -> scene::Point {
    if (time_s < 0.32) return {kArm_m - std::min(time_s, 0.32 - time_s), 1e-3 * std::sin(20 * time_s), 0};
    const double angle = (time_s - 0.32) / kArm_m;
    return kArm_m * scene::Point(std::cos(angle), std::sin(angle), 0);
  };
  Ledger ledger;
  scene::Point device_m = path_m(0);
  bodies->move(seat, device_m, scene::Point::Zero());
  const int steps = static_cast<int>(1.5 / timestep_s);
  for (int i = 1; i <= steps; ++i) {
    const scene::Point moved_m = path_m(i * timestep_s) - device_m;
    device_m += moved_m;
    bodies->move(seat, device_m, moved_m / timestep_s);
    bodies->advance(timestep_s);
    ledger.into_J -= bodies->touch(seat).force_N.dot(moved_m);
    const double stretch_m = (device_m - center_of_mass_m(*bodies, "arm")).norm();
    ledger.stored_J = 0.5 * coupling.stiffness_N_per_m * stretch_m * stretch_m + kinetic_J(*bodies);
    ledger.most_stored_J = std::max(ledger.most_stored_J, ledger.stored_J);
    ledger.least_margin_J = std::min(ledger.least_margin_J, ledger.into_J - ledger.stored_J);
  }
  return ledger;
}

TEST(BodyWorld, GivesBackNoMoreOfAnOffCenterBodyThanWasPutIn) {
  const Ledger coarse = drag_an_arm_around(1e-3);
  const Ledger fine = drag_an_arm_around(1e-4);
  EXPECT_GT(coarse.most_stored_J, 0.1) << "energy is stored";
  // The integrator's own error goes down with the step, as the first order that it is.
  EXPECT_GE(coarse.least_margin_J, -0.02 * coarse.most_stored_J);
  EXPECT_GE(fine.least_margin_J, -0.002 * fine.most_stored_J);
}

/// How far the coupling is stretched in the end, after the device has gone a millimetre aside.
double stretch_left_m(const std::string& integrator, const Coupling& coupling) {
  const auto bodies = world_of("<option gravity='0 0 0' timestep='0.001' integrator='" + integrator + R"('/><worldbody>
      <body name="root"><joint type="slide" axis="1 0 0"/><geom size="0.01" mass="0.01" contype="0"/>
        <body name="child"><joint type="slide" axis="1 0 0"/><geom size="0.01" mass="10" contype="0"/></body>
      </body></worldbody>)",
                               "root", coupling);
  const int seat = bodies->join();
  bodies->move(seat, {0, 0, 0}, scene::Point::Zero());
  double most_m = 0;
  for (int i = 0; i < 3000; ++i) {
    bodies->move(seat, {1e-3, 0, 0}, scene::Point::Zero());
    bodies->advance(1e-3);
    if (i > 2900) most_m = std::max(most_m, std::abs(center_of_mass_m(*bodies, "root").x() - 1e-3));
  }
  return most_m;
}

TEST(BodyWorld, CouplingIsStableUpToWhereItIsSaidToBe) {
  constexpr double kApparentMass_kg = 0.01;
  constexpr double kStep_s = 1e-3;
  for (const char* integrator : {"Euler", "implicit"}) {
    for (const double damping_N_s_per_m : {0.0, 1.0, 5.0, 15.0}) {
      // k + 2 b = 4
      const double limit_N_per_m = (4 * kApparentMass_kg / kStep_s - 2 * damping_N_s_per_m) / kStep_s;
      const Coupling below{0.97 * limit_N_per_m, damping_N_s_per_m};
      const Coupling above{1.03 * limit_N_per_m, damping_N_s_per_m};
      EXPECT_LT(below.share_of_stable(kApparentMass_kg, kStep_s), 1);
      EXPECT_GT(above.share_of_stable(kApparentMass_kg, kStep_s), 1);
      EXPECT_LT(stretch_left_m(integrator, below), 0.01) << integrator << ", " << damping_N_s_per_m << " N s/m";
      EXPECT_GT(stretch_left_m(integrator, above), 0.05) << integrator << ", " << damping_N_s_per_m << " N s/m";
    }
  }
}

TEST(BodyWorld, WithoutADamperTheCouplingRingsButDoesNotGrow) {
  for (const double stiffness_N_per_m : {10.0, 1000.0, 20000.0}) {
    EXPECT_NEAR(stretch_left_m("Euler", {stiffness_N_per_m, 0}), 1e-3, 0.5e-3) << stiffness_N_per_m << " N/m";
  }
}

struct Appearance {
  double peak_N = 0;           ///< within 100 ms
  double steepest_N = 0;       ///< of one motion to the next, within a second
  double final_N = 0;          ///< after two seconds
  double fastest_m_per_s = 0;  ///< of the cube
};

Appearance appear_in_a_cube(double mass_kg, const scene::Point& device_m) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(mass_kg, {0, 0, 0.02})}}, "test");
  const auto state = dynamic_model.make_state(1);
  Hand hand(*state);
  Appearance seen;
  scene::Point last_N = scene::Point::Zero();
  for (int i = 0; i < 2000; ++i) {
    const scene::Point force_N = hand.to(device_m).force_N;
    if (i < 100) seen.peak_N = std::max(seen.peak_N, force_N.norm());
    if (i < 1000) seen.steepest_N = std::max(seen.steepest_N, (force_N - last_N).norm());
    last_N = force_N;
    if (mass_kg > 0) {
      const mjData_& data = world(*state).data();
      seen.fastest_m_per_s = std::max(seen.fastest_m_per_s, mju_norm3(data.qvel));
    }
  }
  seen.final_N = last_N.norm();
  return seen;
}

TEST(BodyWorld, ADeviceThatAppearsWithinAWallIsPushedOutSoftly) {
  const Coupling coupling;
  for (const double beside_m : {0.0, 0.01, 0.019}) {
    const Appearance seen = appear_in_a_cube(0, {beside_m, 0, 0.025});
    // The ball of 4 mm begins outside the nearest face. After a fifth of its way the coupling's far end has gone
    // 10.4 % of it, at 1.92 /s of it.
    const double way_m = 0.004 + std::min(0.02 - beside_m, 0.04 - 0.025);
    const double bound_N = way_m * (0.104 * coupling.stiffness_N_per_m + 1.92 * coupling.damping_N_s_per_m);
    EXPECT_LT(seen.peak_N, 1.02 * bound_N) << beside_m;
    EXPECT_GT(seen.peak_N, 0.5 * bound_N) << beside_m << ": it has begun";
    // At its steepest half way: 3/2 K/T of it per second.
    EXPECT_LT(seen.steepest_N, 1.2 * 1e-3 * 1.5 / 0.5 * coupling.stiffness_N_per_m * way_m) << beside_m;
    EXPECT_NEAR(seen.final_N, coupling.stiffness_N_per_m * way_m, 0.02 * coupling.stiffness_N_per_m * way_m)
        << beside_m << ": in the end the wall is as stiff as any";
  }
}

TEST(BodyWorld, ADeviceThatAppearsWithinABodyDoesNotThrowIt) {
  for (const double beside_m : {0.0, 0.01, 0.019}) {
    const Appearance seen = appear_in_a_cube(0.1, {beside_m, 0, 0.025});
    EXPECT_LT(seen.peak_N, 2) << beside_m;
    EXPECT_LT(seen.steepest_N, 0.25) << beside_m;
    EXPECT_LT(seen.fastest_m_per_s, 0.2) << beside_m;
  }
}

auto floating_ball() {
  return world_of(
      "<option gravity='0 0 0' timestep='0.001'/><worldbody><body name='b'><freejoint/><geom size='0.01' mass='0.1'/>"
      "</body></worldbody>",
      "b", {.stiffness_N_per_m = 300, .damping_N_s_per_m = 10});
}

TEST(BodyWorld, ABodyFarFromItsDeviceComesWithoutAJerk) {
  const auto bodies = floating_ball();
  Hand hand(*bodies);
  double last_N = 0;
  for (int i = 0; i < 3000; ++i) {
    const double force_N = hand.to({0.15, 0, 0}).force_N.norm();
    // 15 cm in half a second: accelerations of up to 6 * 0.15 / 0.5^2 = 3.6 m/s^2, which the mass answers, overshooting
    // a little, and the damper from one motion to the next.
    EXPECT_LT(force_N, 1.1 * 0.1 * 3.6) << i;
    EXPECT_LT(std::abs(force_N - last_N), 1.1 * 10 * 3.6 * 1e-3) << i;
    last_N = force_N;
  }
  EXPECT_LT((center_of_mass_m(*bodies, "b") - scene::Point(0.15, 0, 0)).norm(), 1e-6);
}

TEST(BodyWorld, ABodyFarFromItsDeviceComesNoFasterThanAHandCanFollow) {
  const auto bodies = floating_ball();
  Hand hand(*bodies);
  double fastest_m_per_s = 0;
  for (int i = 0; i < 3000; ++i) {
    (void)hand.to({0.9, 0, 0});
    fastest_m_per_s = std::max(fastest_m_per_s, mju_norm3(bodies->data().qvel));
  }
  EXPECT_NEAR(fastest_m_per_s, 0.6, 0.01);
  EXPECT_LT((center_of_mass_m(*bodies, "b") - scene::Point(0.9, 0, 0)).norm(), 1e-6);
}

TEST(BodyWorld, AReturnOfMuJoCoToTheStartTakesNoContactsFromThoseLeftOut) {
  const auto bodies = world_of(
      "<size nconmax='2' njmax='100'/><worldbody><geom type='box' size='1 1 0.05' pos='0 0 -0.05'/><body name='box' "
      "pos='0 0 0.02'><freejoint/><geom type='box' size='0.02 0.02 0.02' mass='0.1'/></body></worldbody>",
      "box", {.stiffness_N_per_m = 100, .damping_N_s_per_m = 1});
  bodies->advance(0.05);
  const std::uint64_t before = bodies->faults().contacts_left_out;
  EXPECT_GT(before, 0U);
  bodies->data().qvel[0] = std::nan("");
  bodies->advance(0.05);
  EXPECT_FALSE(bodies->sound());
  EXPECT_EQ(bodies->faults().contacts_left_out, before);
}

TEST(BodyWorld, ASilentDevicesVelocityIsBelievedAsLongInOneAdvanceAsInMany) {
  const auto force_N = [](int advances) -> scene::Point {
    const BodyDynamicModel dynamic_model({.bodies = {floor_plate()}}, "test");
    const auto state = dynamic_model.make_state(1);
    Hand hand(*state);
    (void)hand.along({0, 0, 0.1}, {0.1, 0, 0.1});
    for (int i = 0; i < advances; ++i) state->advance(0.04 / advances);
    return state->touch(0).force_N;
  };
  EXPECT_GT(force_N(40).norm(), 1e-4) << "it still swings";
  EXPECT_LT((force_N(1) - force_N(40)).norm(), 1e-9);
}

TEST(BodyWorld, TheSmallestStepKeepsPaceWithAKilohertz) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}, .timestep_s = 1e-4},
                                       "test");
  const auto state = dynamic_model.make_state(1);
  Hand hand(*state);
  for (int i = 0; i < 3000; ++i) (void)hand.to({0.1, 0, 0.1 + 1e-5 * i});
  EXPECT_EQ(state->faults().slipped_s, 0);
  EXPECT_NEAR(world(*state).data().time, 3, 1.5e-4);
  EXPECT_TRUE(state->sound());
}

TEST(BodyWorld, ClientsOfOtherRatesAndSilentOnesShareItWithoutABlow) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = dynamic_model.make_state(3);
  const int fast = state->join();
  const int slow = state->join();
  const int unmoved = state->join();
  const auto at = [](double y_m, double time_s) {
    return scene::Point(0.05 * std::cos(2 * std::numbers::pi * time_s), y_m, 0.1);
  };
  const auto velocity = [](double time_s) {
    return scene::Point(-0.05 * 2 * std::numbers::pi * std::sin(2 * std::numbers::pi * time_s), 0, 0);
  };
  state->move(unmoved, {0, 0.2, 0.1}, {0.1, 0, 0});
  double fast_N = 0;
  double slow_N = 0;
  double unmoved_N = 0;
  for (int i = 0; i < 3000; ++i) {
    const double time_s = i * 1e-3;
    state->move(fast, at(-0.1, time_s), velocity(time_s));
    if (i % 10 == 0) state->move(slow, at(0.1, time_s), velocity(time_s));
    state->advance(1e-3);
    fast_N = std::max(fast_N, state->touch(fast).force_N.norm());
    slow_N = std::max(slow_N, state->touch(slow).force_N.norm());
    if (i > 500) unmoved_N = std::max(unmoved_N, state->touch(unmoved).force_N.norm());
  }
  EXPECT_EQ(state->faults().slipped_s, 0);
  EXPECT_TRUE(state->sound());
  const double fastest_m_per_s = 0.05 * 2 * std::numbers::pi;
  EXPECT_LT(fast_N, 0.1) << "the ball's inertia, 0.03 kg at 2 m/s^2";
  EXPECT_LT(slow_N, 600 * fastest_m_per_s * 10e-3) << "the spring over the way of ten milliseconds";
  EXPECT_LT(unmoved_N, 1e-6) << "held where it was";
}

TEST(BodyWorld, IsSeenWhereItsBodiesAreButNotTheBallsOfDevices) {
  const BodyDynamicModel model({.bodies = {{.name = "block",
                                            .size_m = scene::Point(0.02, 0.04, 0.06),
                                            .mass_kg = 0.1,
                                            .position_m = scene::Point(0, 0, 0.5)}}},
                               "test");
  const auto state = model.make_state(2);
  const std::vector<scene::VisiblePart> parts = state->visible();
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].name, "block");
  EXPECT_EQ(parts[0].kind, scene::VisiblePart::Kind::box);
  EXPECT_LT((parts[0].half_m - scene::Point(0.01, 0.02, 0.03)).norm(), 1e-9);
  std::array<float, 10> seen{};
  ASSERT_EQ(state->sample(0, seen), 7U);
  EXPECT_NEAR(seen[2], 0.5, 1e-6);
  EXPECT_NEAR(seen[3], 1, 1e-6);
  for (int i = 0; i < 100; ++i) state->advance(1e-3);
  ASSERT_EQ(state->sample(0, seen), 7U);
  EXPECT_NEAR(seen[2], 0.5 - 0.5 * 9.80665 * 0.01, 2e-3) << "it falls";
  EXPECT_EQ(state->sample(1, seen), 0U);
  EXPECT_EQ(state->sample(0, std::span(seen).first(6)), 0U);
}

}  // namespace
}  // namespace forcebound::server
