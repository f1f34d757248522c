#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "forcebound/server/dynamics/bodies/body_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/dynamics/bodies/hand.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kGravity = 9.80665;

std::string error_of(const BodiesDescription& description) {
  try {
    const BodyDynamicModel dynamic_model(description, "scene.toml: bodies");
  } catch (const BodiesError& error) {
    return error.what();
  }
  return "no error";
}

TEST(BodyDynamicModel, AProbeAtRestInFreeSpaceHasNoForce) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate()}}, "test");
  const auto state = dynamic_model.make_state(1);
  EXPECT_LT(Hand(*state).rest_at({0, 0, 0.1}, 200).force_N.norm(), 1e-9);
}

TEST(BodyDynamicModel, ProbePressedIntoTheFloorFeelsTheCouplingsSpring) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate()}}, "test");
  const auto state = dynamic_model.make_state(1);
  Hand hand(*state);
  (void)hand.along({0, 0, 0.01}, {0, 0, 0});
  // The probe's ball of 4 mm rests on the floor; its middle is held 4 mm above where the device is.
  const scene::ModelTouch touch = hand.rest_at({0, 0, 0}, 500);
  EXPECT_NEAR(touch.force_N.z(), 600 * 0.004, 0.05);
  EXPECT_LT(touch.force_N.head(2).norm(), 1e-3);
  EXPECT_NEAR(touch.normal.z(), 1, 1e-3);
  EXPECT_NEAR(touch.penetration_m, 0.004, 1e-4);
}

TEST(BodyDynamicModel, ALiftedCubeHasItsWeight) {
  // Held from below, without a floor: the hand feels the weight.
  const BodyDynamicModel dynamic_model({.bodies = {cube(0.1, {0, 0, 0.0245})}, .probe = {.radius_m = 0.004}}, "test");
  const auto state = dynamic_model.make_state(1);
  const scene::ModelTouch touch = Hand(*state).rest_at({0, 0, 0}, 400);
  EXPECT_NEAR(touch.force_N.z(), -0.1 * kGravity, 0.1);
}

TEST(BodyDynamicModel, PushedCubeSlidesAlong) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = dynamic_model.make_state(1);
  Hand hand(*state);
  const scene::ModelTouch touch = hand.along({-0.05, 0, 0.02}, {0.03, 0, 0.02});
  EXPECT_LT(touch.force_N.x(), -0.2) << "friction of 0.5 and a weight of 1 N, less the slack of the contacts";
  EXPECT_GT(touch.force_N.x(), -1.5);
}

TEST(BodyDynamicModel, MuJoCosOwnSolverChangesNoBit) {
  const auto forces = [](const SolverOptions& solver) {
    const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}, .solver = solver},
                                         "test");
    const auto state = dynamic_model.make_state(1);
    Hand hand(*state);
    std::vector<double> all;
    all.reserve(200);
    for (int i = 0; i < 200; ++i) all.push_back(hand.to({-0.03 + 1e-4 * i, 0, 0.03}).force_N.x());
    return all;
  };
  using Kind = SolverOptions::Kind;
  EXPECT_EQ(forces({}), forces({.kind = Kind::newton, .iterations = 100, .tolerance = 1e-8}));
  EXPECT_NE(forces({}), forces({.kind = Kind::pgs, .iterations = 1}));
}

TEST(BodyDynamicModel, HasTheSolverItWasToldForAnyNumberOfProbes) {
  using Kind = SolverOptions::Kind;
  const BodyDynamicModel dynamic_model(
      {.bodies = {floor_plate()}, .solver = {.kind = Kind::cg, .iterations = 3, .tolerance = 1e-3}}, "test");
  for (const int seats : {1, 2}) {
    const auto state = dynamic_model.make_state(seats);
    const SolverOptions solver = solver_of(dynamic_cast<const BodyWorld&>(*state).model());
    EXPECT_EQ(solver.kind, Kind::cg);
    EXPECT_EQ(solver.iterations, 3);
    EXPECT_EQ(solver.tolerance, 1e-3);
  }
}

BodiesDescription sliding_cube(const SolverOptions& solver = {}) {
  return {.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}, .solver = solver};
}

/// Down on the cube's side and along, so that it tilts and slides.
scene::Point pushing_m(int tick) { return {-0.03 + 1e-4 * tick, 0.005, 0.03}; }

TEST(BodyDynamicModel, ACopyOfAStateGoesOnToTheBitAsTheOriginal) {
  const BodyDynamicModel dynamic_model(sliding_cube(), "test");
  const auto original = dynamic_model.make_state(1);
  const auto copy = dynamic_model.make_state(1);
  Hand hand(*original);
  Hand other(*copy);
  for (int i = 0; i < 150; ++i) {
    (void)hand.to(pushing_m(i));
    (void)other.to(pushing_m(3 * i) + scene::Point(0, 0.1, 0));
  }
  ASSERT_TRUE(copy->copy_from(*original));
  for (int i = 150; i < 300; ++i) {
    const scene::Point moved_m_per_s = (pushing_m(i) - pushing_m(i - 1)) / 1e-3;
    for (scene::DynamicModelState* const state : {original.get(), copy.get()}) {
      state->move(0, pushing_m(i), moved_m_per_s);
      state->advance(1e-3);
    }
    const scene::ModelTouch touch = original->touch(0);
    ASSERT_EQ(copy->touch(0).force_N, touch.force_N) << i;
    ASSERT_EQ(copy->touch(0).penetration_m, touch.penetration_m) << i;
  }
}

TEST(BodyDynamicModel, CopiesAStateToBodiesThatAreSetUpOtherwiseButNotToOthers) {
  const BodyDynamicModel dynamic_model(sliding_cube(), "test");
  const auto state = dynamic_model.make_state(1);
  const auto bare = BodyDynamicModel({.bodies = {floor_plate()}}, "test").make_state(1);
  EXPECT_TRUE(BodyDynamicModel(sliding_cube({.kind = SolverOptions::Kind::pgs, .iterations = 1}), "test")
                  .make_state(1)
                  ->copy_from(*state));
  EXPECT_FALSE(bare->copy_from(*state));
  EXPECT_FALSE(dynamic_model.make_state(2)->copy_from(*state));
}

TEST(BodyDynamicModel, TwoProbesFeelTheSameCubeAndNotEachOther) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = dynamic_model.make_state(2);
  Hand one(*state);
  Hand other(*state);
  (void)other.to({0, 0.1, 0.1});
  EXPECT_EQ(state->join(), -1) << "both seats are taken";
  (void)one.along({-0.05, 0, 0.02}, {0.02, 0, 0.02});
  // The cube has gone from the origin to x = 44 mm; the other hand finds it there.
  const scene::ModelTouch found = other.along({0.1, 0, 0.02}, {0.06, 0, 0.02});
  EXPECT_GT(found.force_N.x(), 0.1);
}

TEST(BodyDynamicModel, ASeatLeftIsFreeAndItsProbeIsGone) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = dynamic_model.make_state(1);
  {
    Hand hand(*state);
    (void)hand.to({0.1, 0, 0.1});
  }
  state->leave(0);
  for (int i = 0; i < 100; ++i) state->advance(1e-3);
  EXPECT_TRUE(state->sound());
  EXPECT_EQ(state->join(), 0);
}

TEST(BodyDynamicModel, StepsAreOfFixedLengthAndWhatCannotBeMadeUpForIsCounted) {
  const BodyDynamicModel dynamic_model({.bodies = {cube(1, {0, 0, 10})}, .timestep_s = 2e-3}, "test");
  const auto state = dynamic_model.make_state(1);
  for (int i = 0; i < 100; ++i) state->advance(1e-3);
  EXPECT_EQ(state->faults().slipped_s, 0);
  state->advance(1);
  EXPECT_NEAR(state->faults().slipped_s, 1 - 50 * 2e-3, 1e-9);
}

TEST(BodyDynamicModel, AnUnstableCouplingIsRefusedWithTheNumbers) {
  BodiesDescription stiff{.bodies = {floor_plate()}};
  stiff.probe.mass_kg = 0.001;
  stiff.coupling = {.stiffness_N_per_m = 5000, .damping_N_s_per_m = 0};
  EXPECT_EQ(error_of(stiff),
            "scene.toml: bodies: the probe's coupling of 5000 N/m and 0 N s/m is unstable with an apparent mass of "
            "0.001 kg in "
            "steps of 0.001 s (1.25 of what is stable): use a softer one, a heavier probe or shorter steps");
}

TEST(BodyDynamicModel, MjcfIsDraggedByItsProbe) {
  const std::string text = R"(<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody>
    <body name="block" pos="0 0 0"><freejoint/><geom type="box" size="0.02 0.02 0.02" mass="0.2"/></body>
  </worldbody></mujoco>)";
  const BodyDynamicModel dynamic_model(compile_mjcf(text, "block.xml"), {"block"},
                                       {.stiffness_N_per_m = 300, .damping_N_s_per_m = 10}, "block.xml");
  const auto state = dynamic_model.make_state(1);
  Hand hand(*state);
  const scene::ModelTouch begin = hand.along({0, 0, 0}, {0.002, 0, 0});
  EXPECT_LT(begin.force_N.x(), -0.01) << "its mass is felt";
  EXPECT_LT(hand.rest_at({0.002, 0, 0}, 2000).force_N.norm(), 1e-3) << "it has come after";
}

TEST(BodyDynamicModel, AProbeOfMjcfMustBeThereAndMoveByAPullAtItsCenterOfMass) {
  const auto refusal = [](const std::string& bodies, const std::string& probe) -> std::string {
    try {
      const BodyDynamicModel dynamic_model(
          compile_mjcf("<mujoco><worldbody>" + bodies + "</worldbody></mujoco>", "peg.xml"), {probe}, {}, "peg.xml");
    } catch (const BodiesError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("<body name='peg'><freejoint/><geom size='0.1'/></body>", "pegg"),
            "peg.xml: no body 'pegg' to be the probe, did you mean 'peg'? (known: peg)");
  const std::string immovable = "peg.xml: body 'peg' must have a joint that moves its centre of mass to be the probe";
  EXPECT_EQ(refusal("<body name='peg'><geom size='0.1'/></body>", "peg"), immovable);
  EXPECT_EQ(refusal("<body name='peg'><joint axis='1 2 3'/><geom size='0.1'/></body>", "peg"), immovable);
}

std::string refusal_of_mjcf(const std::string& option, const std::string& bodies) {
  try {
    const BodyDynamicModel dynamic_model(
        compile_mjcf("<mujoco><option timestep='0.002' " + option + "/>" + bodies + "</mujoco>", "peg.xml"), {"peg"},
        {}, "peg.xml");
  } catch (const BodiesError& error) {
    return error.what();
  }
  return "accepted";
}

std::string peg_on(const std::string& joint) {
  return "<worldbody><body name='peg'><joint " + joint + "/><geom size='0.01' mass='0.05'/></body></worldbody>";
}

TEST(BodyDynamicModel, RefusesMjcfThatIsUnstableByItselfAndSaysWhatHelps) {
  const auto spring = [](double h2_k_over_m) {
    const double stiffness_N_per_m = h2_k_over_m * 0.05 / (0.002 * 0.002);
    return peg_on("name='rail' type='slide' stiffness='" + std::to_string(stiffness_N_per_m) + "'");
  };
  EXPECT_THAT(
      refusal_of_mjcf("", spring(4.8)),
      AllOf(StartsWith("peg.xml: joint 'rail' is at "), HasSubstr(" steps of 0.002 s after a small disturbance"),
            HasSubstr("use a shorter timestep, softer springs and actuators, or for strong damping the "
                      "integrator implicit")));
  // With the coupling's spring of 0.05 and its damper of twice 0.16 it is stable up to 3.63.
  EXPECT_THAT(refusal_of_mjcf("gravity='0 0 0'", spring(3.7)), StartsWith("peg.xml: joint 'rail' is at "));
  EXPECT_EQ(refusal_of_mjcf("", spring(3.5)), "accepted");
}

TEST(BodyDynamicModel, FindsWhatIsUnstableAsideOfTheProbeAndWithoutAForceAtTheStart) {
  const std::string other =
      "<worldbody><body name='peg'><freejoint/><geom size='0.01' mass='0.05'/></body><body name='other' pos='1 0 0'>";
  const std::string ball = "<geom size='0.01' mass='0.05'/></body></worldbody>";
  EXPECT_THAT(refusal_of_mjcf("gravity='0 0 0'", other + "<joint type='slide' stiffness='60000'/>" + ball),
              StartsWith("peg.xml: a joint of body 'other' is at "));
  // Turned by at most half a turn, it stays finite.
  EXPECT_THAT(refusal_of_mjcf("gravity='0 0 0'", other + "<joint type='ball' stiffness='3'/>" + ball),
              StartsWith("peg.xml: a joint of body 'other' is at "));
}

TEST(BodyDynamicModel, DampingThatIsTooMuchForEulerIsTakenWithImplicit) {
  const std::string held =
      peg_on("name='rail' type='slide'") + "<actuator><velocity joint='rail' kv='200'/></actuator>";
  EXPECT_THAT(refusal_of_mjcf("", held), HasSubstr("joint 'rail' is at "));
  EXPECT_EQ(refusal_of_mjcf("integrator='implicit'", held), "accepted");
}

TEST(BodyDynamicModel, TakesMjcfThatFallsSwingsOrIsDriven) {
  const std::string falls = "<worldbody><body name='peg'><freejoint/><geom size='0.01' mass='1'/></body></worldbody>";
  EXPECT_EQ(refusal_of_mjcf("gravity='0 0 -1000'", falls), "accepted");
  const std::string upright =
      "<worldbody><body name='a'><joint axis='0 1 0'/><geom type='capsule' fromto='0 0 0 0 0 .1' size='.005'/>"
      "<body name='peg' pos='0 0 .1'><joint axis='0 1 0'/><geom type='capsule' fromto='0 0 0 0 0 .1' size='.005'/>"
      "</body></body></worldbody>";
  EXPECT_EQ(refusal_of_mjcf("", upright), "accepted") << "it tips over, but stays finite";
  EXPECT_EQ(refusal_of_mjcf("", peg_on("name='rail' type='slide' springref='0.5' stiffness='1000'") +
                                    "<actuator><position joint='rail' kp='1000'/></actuator>"),
            "accepted");
}

TEST(BodyDynamicModel, BodiesMayBeCalledWhatMuJoCoAndTheProbesAreCalled) {
  std::vector<BodyDescription> bodies{floor_plate()};
  for (const char* name : {"world", "probe 0", "probe 1", "body probe 1", "body world"}) {
    bodies.push_back(cube(0.1, {0, 0, 0.021 + 0.041 * static_cast<double>(bodies.size() - 1)}));
    bodies.back().name = name;
  }
  const BodyDynamicModel dynamic_model({.bodies = bodies}, "test");
  const auto state = dynamic_model.make_state(2);
  Hand hand(*state);
  EXPECT_LT(hand.rest_at({0.3, 0, 0.1}, 100).force_N.norm(), 1e-9) << "it drags a probe, no cube";
  bodies[2].position_m = bodies[1].position_m;
  EXPECT_EQ(error_of({.bodies = bodies}).rfind("scene.toml: bodies: 'world' and 'probe 0' begin ", 0), 0U);
}

TEST(BodyDynamicModel, DoesNotAllocate) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02})}}, "test");
  const auto state = dynamic_model.make_state(1);
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  const int seat = state->join();
  for (int i = 0; i < 100; ++i) {
    // It begins within the cube.
    state->move(seat, {-0.01 - 1e-4 * i, 0, 0.02}, {-0.1, 0, 0});
    state->advance(1e-3);
    (void)state->touch(seat);
  }
  state->leave(seat);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(BodyDynamicModel, IsTriedWhereADeviceMeetsItFromAbove) {
  const auto at = [](std::vector<BodyDescription> bodies) {
    return BodyDynamicModel({.bodies = std::move(bodies)}, "test").facts().on_surface_m;
  };
  EXPECT_LT((at({floor_plate()}) - scene::Point(0, 0, 0)).norm(), 1e-12);
  EXPECT_LT((at({cube(0.1, {0.3, 0.1, 0.5})}) - scene::Point(0.3, 0.1, 0.52)).norm(), 1e-12);
  EXPECT_LT((at({floor_plate(), cube(0.1, {0, 0, 0.02})}) - scene::Point(0, 0, 0.04)).norm(), 1e-12)
      << "the floor's middle is covered";
  const BodyDescription upright{.name = "rod",
                                .shape = "capsule",
                                .size_m = scene::Point::Constant(0.02),
                                .half_axis_m = {0, 0, 0.1},
                                .mass_kg = 1,
                                .position_m = {0.2, 0, 0}};
  EXPECT_LT((at({upright}) - scene::Point(0.2, 0, 0.11)).norm(), 1e-12);
}

TEST(BodyDynamicModel, IsTriedWhereADeviceDragsABodyOfTheAuthors) {
  const BodyDynamicModel dynamic_model(
      compile_mjcf(R"(<mujoco><worldbody><body name="rod" pos="0.1 0 0.5"><joint axis="0 1 0"/>
      <geom type="box" pos="0.2 0 0" size="0.1 0.01 0.01"/></body></worldbody></mujoco>)",
                   "rod.xml"),
      {"rod"}, {}, "rod.xml");
  EXPECT_LT((dynamic_model.facts().on_surface_m - scene::Point(0.3, 0, 0.5)).norm(), 1e-12);
}

TEST(BodyDynamicModel, PredictsAsManyStepsAsAMotionTakes) {
  const auto cost_ns = [](double timestep_s) {
    return BodyDynamicModel({.bodies = {floor_plate()}, .timestep_s = timestep_s}, "test").facts().cost_ns;
  };
  EXPECT_NEAR(cost_ns(1e-4), 10 * cost_ns(1e-3), 1e-6);
  EXPECT_EQ(cost_ns(5e-3), cost_ns(1e-3)) << "the motion that takes the step takes all of it";
}

TEST(BodyDynamicModel, PredictsLooksAboutTheDraggedBodyPastEveryGeomAndTriangle) {
  const auto cost_ns = [](int cubes) {
    BodiesDescription description{.bodies = {floor_plate()}};
    // They stand still: no more degrees of freedom.
    for (int i = 0; i < cubes; ++i) {
      BodyDescription still = cube(0, {0.1 * i, 0.5, 0.02});
      still.name += " " + std::to_string(i);
      description.bodies.push_back(std::move(still));
    }
    const BodyDynamicModel dynamic_model(std::move(description), "test");
    return dynamic_model.facts().describe_cost_ns;
  };
  EXPECT_GT(cost_ns(0), 0);
  EXPECT_GT(cost_ns(10), cost_ns(0));
  EXPECT_NEAR(cost_ns(20) - cost_ns(10), cost_ns(10) - cost_ns(0), 1e-6);
}

TEST(BodyDynamicModel, AStateThatIsNotFiniteIsReportedAndWritesNoLogFile) {
  const bool before = std::filesystem::exists("MUJOCO_LOG.TXT");
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate()}}, "test");
  const auto state = dynamic_model.make_state(1);
  auto& world = dynamic_cast<BodyWorld&>(*state);
  world.data().qvel[0] = std::nan("");
  EXPECT_TRUE(state->sound());
  (void)Hand(*state).to({0, 0, 0.1});
  EXPECT_TRUE(state->sound()) << "placing the probe has set its velocity";
  world.data().qvel[0] = std::nan("");
  state->advance(1e-3);
  EXPECT_FALSE(state->sound());
  state->advance(1e-3);
  EXPECT_FALSE(state->sound()) << "and it stays so";
  EXPECT_EQ(std::filesystem::exists("MUJOCO_LOG.TXT"), before);
}

TEST(BodyDynamicModel, ADeviceThatJumpsFarAwayPullsNoHarderThanItsReach) {
  const BodyDynamicModel dynamic_model({.bodies = {floor_plate()}}, "test");
  const auto state = dynamic_model.make_state(1);
  Hand hand(*state);
  (void)hand.to({0, 0, 0.1});
  (void)hand.to({0, 0, 1e6});
  for (int i = 0; i < 1000; ++i) (void)hand.to({0, 0, 0.1});
  EXPECT_TRUE(state->sound());
}

}  // namespace
}  // namespace forcebound::server
