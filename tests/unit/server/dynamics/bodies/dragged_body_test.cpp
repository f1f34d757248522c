#include "forcebound/server/dynamics/bodies/dragged_body.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/body_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/dynamics/bodies/hand.hpp"

namespace forcebound::server {
namespace {

using local_model::Contact;
using local_model::Mass;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kDragged_kg = 0.1;
constexpr double kDraggedRadius_m = 0.005;

/// A ball at the origin, of 5 mm radius and without weight, among geoms and bodies, as it is told of.
struct Told {
  ModelPointer model;
  DataPointer data;
  DraggedBodies bodies;
  DraggedBody dragged;

  explicit Told(const std::string& around, const std::string& joints = kSlides)
      : model(compile(around, joints)),
        data(make_data(*model)),
        bodies(*model, {}),
        dragged{.body = mj_name2id(model.get(), mjOBJ_BODY, "ball")} {
    forward(*model, *data);
  }

  static constexpr const char* kSlides =
      "<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><joint type='slide' axis='0 0 1'/>";

  static ModelPointer compile(const std::string& around, const std::string& joints) {
    ModelPointer model =
        compile_mjcf("<mujoco><option timestep='0.001' gravity='0 0 0'/><worldbody><body name='ball'>" + joints +
                         "<geom size='0.005' mass='0.1'/></body>" + around + "</worldbody></mujoco>",
                     "b.xml");
    return model;
  }

  Mass describe() {
    const std::optional<Mass> told = bodies.describe(*model, *data, dragged);
    EXPECT_TRUE(told);
    local_model::LocalModel sound{.has_mass = true, .mass = told.value_or(Mass{})};
    EXPECT_TRUE(local_model::is_sound(sound));
    return sound.mass;
  }
  /// The one that it is told of.
  Contact contact() {
    const Mass mass = describe();
    EXPECT_EQ(mass.contact_count, 1U);
    return mass.contacts[0];
  }
  /// Moves the first joint of a body.
  void put(const char* body, double at) {
    const int joint = model->body_jntadr[mj_name2id(model.get(), mjOBJ_BODY, body)];
    data->qpos[model->jnt_qposadr[joint]] = at;
    forward(*model, *data);
  }
};

/// A wall of 1 m whose face towards the ball is so far from the ball's surface, along an axis.
std::string wall_away(double gap_m, const scene::Point& axis) {
  const scene::Point at_m = (gap_m + kDraggedRadius_m + 0.05) * axis;
  const auto half = [&](int of) { return axis[of] == 0 ? "0.5 " : "0.05 "; };
  return std::string("<geom type='box' size='") + half(0) + half(1) + half(2) + "' pos='" + std::to_string(at_m.x()) +
         " " + std::to_string(at_m.y()) + " " + std::to_string(at_m.z()) + "'/>";
}

const scene::Point kX = scene::Point::UnitX();
const scene::Point kY = scene::Point::UnitY();
const scene::Point kZ = scene::Point::UnitZ();

TEST(DraggedBody, InTheAirIsItsMassAlone) {
  Told told(wall_away(0.06, kX));
  told.dragged.force_N = {1, 2, 3};
  const Mass mass = told.describe();
  EXPECT_TRUE(mass.body.mobility_per_kg.isApprox(Eigen::Matrix3d::Identity() / kDragged_kg, 1e-9));
  EXPECT_EQ(mass.force_N, scene::Point(1, 2, 3));
  EXPECT_EQ(mass.stiffness_N_per_m, Coupling{}.stiffness_N_per_m);
  EXPECT_EQ(mass.damping_N_s_per_m, Coupling{}.damping_N_s_per_m);
  EXPECT_EQ(mass.contact_count, 0U);
}

TEST(DraggedBody, TheForceOfTheCouplingIsNoneOfItsBias) {
  Told told("");
  // As BodyWorld pulls.
  told.dragged.force_N = {0.1, 0.2, -0.3};
  Eigen::Map<scene::Point>(told.data->xfrc_applied + 6 * told.dragged.body) = -told.dragged.force_N - 0.5 * kZ;
  forward(*told.model, *told.data);
  EXPECT_LT((told.describe().body.bias_m_per_s2 - scene::Point(0, 0, -0.5 / kDragged_kg)).norm(), 1e-9);
}

TEST(DraggedBody, TellsOfWhatIsNearerThanFiftyMillimetres) {
  EXPECT_EQ(Told(wall_away(0.0501, kX)).describe().contact_count, 0U);
  const Contact near = Told(wall_away(0.0499, kX)).contact();
  EXPECT_NEAR(near.gap_m, 0.0499, 1e-6);
  EXPECT_LT((near.normal + kX).norm(), 1e-9) << "out of the wall";
  EXPECT_TRUE(near.met.mobility_per_kg.isZero(0)) << "it stands still";
  EXPECT_EQ(near.travel_m, kEndless);
}

TEST(DraggedBody, TellsOfWhatItTouchesHowDeepItIsIn) {
  const Contact touched = Told(wall_away(-0.001, kY)).contact();
  EXPECT_NEAR(touched.gap_m, -0.001, 1e-6);
  EXPECT_LT((touched.normal + kY).norm(), 1e-9);
}

TEST(DraggedBody, AContactIsAsMuJoCoPresetsIt) {
  // solref 0.02 1, solimp 0.9 0.95, at no depth: MuJoCo's manual, "Solver parameters".
  const Contact contact = Told(wall_away(0.01, kZ)).contact();
  EXPECT_NEAR(contact.compliance_per_kg, 0.1 / 0.9 / kDragged_kg, 1e-6);
  EXPECT_NEAR(contact.stiffness_per_s2, 0.9 / (0.95 * 0.02 * 0.95 * 0.02), 1e-6);
  EXPECT_NEAR(contact.damping_per_s, 2 / (0.95 * 0.02), 1e-9);
  EXPECT_NEAR(contact.friction, 1, 1e-12);
}

TEST(DraggedBody, TellsOfTheThreeNearest) {
  // In the order of their geometries, the nearest last.
  const Mass mass =
      Told(wall_away(0.04, kX) + wall_away(0.03, -kX) + wall_away(0.02, kY) + wall_away(0.01, -kZ)).describe();
  ASSERT_EQ(mass.contact_count, 3U);
  std::vector<Contact> contacts(mass.contacts.begin(), mass.contacts.end());
  std::ranges::sort(contacts, {}, &Contact::gap_m);
  EXPECT_NEAR(contacts[0].gap_m, 0.01, 1e-6);
  EXPECT_LT((contacts[0].normal - kZ).norm(), 1e-9);
  EXPECT_NEAR(contacts[1].gap_m, 0.02, 1e-6);
  EXPECT_NEAR(contacts[2].gap_m, 0.03, 1e-6);
  EXPECT_LT((contacts[2].normal - kX).norm(), 1e-9);
}

TEST(DraggedBody, TwoOnOneSideAreOneTheNearest) {
  EXPECT_NEAR(Told(wall_away(0.03, kX) + wall_away(0.02, kX)).contact().gap_m, 0.02, 1e-6);
}

TEST(DraggedBody, OnTwoPointsOfOneSurfaceItIsHeldTwiceAsHard) {
  const auto compliance_per_kg = [](const std::string& geom) {
    ModelPointer model = compile_mjcf(
        "<mujoco><option gravity='0 0 0'/><worldbody>"
        "<geom type='plane' size='1 1 1'/><body name='rod' pos='0 0 0.0099'><freejoint/>"
        "<geom size='0.01 0.05' mass='0.1' " +
            geom + "/></body></worldbody></mujoco>",
        "rod.xml");
    const DataPointer data = make_data(*model);
    forward(*model, *data);
    DraggedBodies bodies(*model, {});
    const auto told = bodies.describe(*model, *data, {.body = 1});
    EXPECT_TRUE(told && told->contact_count == 1);
    return told->contacts[0].compliance_per_kg / model->body_invweight0[2];
  };
  EXPECT_NEAR(compliance_per_kg("type='capsule' euler='0 90 0'") / compliance_per_kg("type='sphere'"), 0.5, 0.05);
}

TEST(DraggedBody, ASurfaceIsThereAsFarAsItGoesOn) {
  const auto radius_m = [](const std::string& geom) { return Told("<geom " + geom + "/>").contact().radius_m; };
  // Its face is 10 mm from the ball's surface, its sides 0.2 and 0.1 m from the middle.
  const std::string box = "type='box' size='0.2 0.1 0.05' pos='";
  EXPECT_NEAR(radius_m(box + "0 0 -0.065'"), 0.1, 1e-9);
  EXPECT_NEAR(radius_m(box + "0.15 0 -0.065'"), 0.05, 1e-9);
  EXPECT_NEAR(radius_m(box + "0.05 0.08 -0.065'"), 0.02, 1e-9);
  EXPECT_NEAR(radius_m(box + "0 -0.098 -0.065'"), 0.005, 1e-9) << "at least as what is round";
  EXPECT_NEAR(radius_m("type='box' size='0.2 0.1 0.05' euler='0 0 90' pos='0.07 0 -0.065'"), 0.03, 1e-9);
  EXPECT_EQ(radius_m("type='plane' size='1 1 1' pos='0 0 -0.015'"), kEndless);
  EXPECT_NEAR(radius_m("size='0.1' pos='0 0 -0.115'"), 0.015, 1e-9) << "a ball, 10 mm away";
}

TEST(DraggedBody, WhereAndHowNearItIsIsOfNow) {
  Told told(wall_away(0.02, kX));
  told.data->qvel[0] = 0.5;
  forward(*told.model, *told.data);
  told.dragged.since_s = 0.002;
  EXPECT_NEAR(told.describe().place_m.x(), 0.001, 1e-12);
  EXPECT_NEAR(told.contact().gap_m, 0.019, 1e-6);
}

TEST(DraggedBody, ALimitOfItsJointsIsAContactToo) {
  const std::string limited = "<joint type='slide' axis='1 0 0' limited='true' range='-0.02 0.08'/>";
  Told told("", limited);
  Contact stop = told.contact();
  EXPECT_NEAR(stop.gap_m, 0.02, 1e-9);
  EXPECT_LT((stop.normal - kX).norm(), 1e-9) << "the one at -x";
  told.put("ball", 0.07);
  stop = told.contact();
  EXPECT_NEAR(stop.gap_m, 0.01, 1e-9);
  EXPECT_LT((stop.normal + kX).norm(), 1e-9) << "the one at +x";
  EXPECT_TRUE(stop.met.mobility_per_kg.isZero(0));
}

constexpr const char* kCube20mmAway =
    "<body name='cube' pos='0.045 0 0'><freejoint/><geom type='box' size='0.02 0.02 0.02' mass='0.4'/></body>";

TEST(DraggedBody, WhatItMayPushGoesUntilItMeetsWhatStands) {
  Contact cube = Told(kCube20mmAway).contact();
  EXPECT_LT((cube.met.mobility_per_kg * kX - kX / 0.4).norm(), 1e-6) << "through its middle";
  EXPECT_EQ(cube.travel_m, kEndless);
  EXPECT_EQ(cube.return_m, kEndless);
  cube = Told(kCube20mmAway + wall_away(0.09, kX)).contact();
  EXPECT_NEAR(cube.travel_m, 0.03, 1e-6) << "40 mm of the 70 mm between are the cube";
  EXPECT_EQ(cube.return_m, kEndless);
}

TEST(DraggedBody, AButtonGoesAsFarAsItsJoint) {
  Told told(R"(<body name="cap" pos="0 0 -0.02"><joint type="slide" axis="0 0 1" limited="true" range="-0.005 0.001"
      stiffness="400" damping="1.5"/><geom type="box" size="0.01 0.01 0.005" mass="0.03"/></body>)");
  const Contact cap = told.contact();
  EXPECT_NEAR(cap.met.mobility_per_kg(2, 2), 1 / 0.03, 1e-6);
  EXPECT_NEAR(cap.met.spring_N_per_m, 400, 1e-6);
  EXPECT_NEAR(cap.met.damper_N_s_per_m, 1.5, 1e-6);
  EXPECT_NEAR(cap.travel_m, 0.005, 1e-9);
  EXPECT_NEAR(cap.return_m, 0.001, 1e-9);
}

// On a table whose upper face is at 0: 10 um in it, with the ball 10 mm above, or a hundredth of a millimetre over it.
constexpr const char* kCubeOnTable = R"(<geom type="plane" size="1 1 1" pos="0 0 -0.055"/>
    <body name="cube" pos="0 0 -0.035"><joint type="slide" axis="0 0 1"/><geom type="box" size="0.02 0.02 0.02"
    mass="0.4"/></body>)";
constexpr double kOnTable_m = -1e-5;
constexpr double kOverTable_m = 1e-5;

TEST(DraggedBody, WhatTremblesCountsAsHeldForAFifthOfASecondIfItHardlyLifts) {
  Told told(kCubeOnTable);
  const auto up_times_mass = [&](double at_m, double time_s) {
    told.put("cube", at_m);
    told.data->time = time_s;
    const Mass mass = told.describe();
    const auto* const cube = std::ranges::find_if(
        mass.contacts, [](const Contact& contact) { return !contact.met.mobility_per_kg.isZero(0); });
    return cube == mass.contacts.end() ? 0.0 : 0.4 * cube->met.mobility_per_kg(2, 2);
  };
  EXPECT_NEAR(up_times_mass(kOverTable_m, 0.9), 1, 1e-3) << "nothing has held it yet";
  EXPECT_LT(up_times_mass(kOnTable_m, 1), 1e-3);
  EXPECT_LT(up_times_mass(kOverTable_m, 1.199), 1e-3);
  EXPECT_NEAR(up_times_mass(kOverTable_m, 1.201), 1, 1e-3);
  EXPECT_LT(up_times_mass(kOnTable_m, 1.202), 1e-3) << "at once again";
  EXPECT_LT(up_times_mass(kOnTable_m + 4.9e-4, 1.3), 1e-3);
  EXPECT_LT(up_times_mass(kOnTable_m + 5.2e-4, 1.231), 1e-3);
  EXPECT_NEAR(up_times_mass(kOnTable_m + 5.2e-4, 1.233), 1, 1e-3) << "lifted";
}

TEST(DraggedBody, WhatHopsWhilePushedIsHeldByTheWholeTable) {
  BodyDescription sled{.name = "sled", .size_m = {0.06, 0.06, 0.04}, .mass_kg = 0.6, .position_m = {0, 0, 0.02}};
  const BodyDynamicModel bodies(
      {.bodies = {floor_plate(), sled}, .contact_time_s = 0.002, .probe = {.radius_m = 0.006}}, "test");
  const auto state = bodies.make_state(1);
  Hand hand(*state);
  (void)hand.rest_at({-0.055, 0, 0.02}, 600);
  const double dry_N = 0.5 * 0.6 * 9.80665;
  int pushed = 0;
  for (int i = 1; i <= 600; ++i) {
    const scene::Point at_m(-0.055 + 1e-4 * i, 0, 0.02);
    const bool pushes = hand.to(at_m).force_N.x() < -1;
    // As often as motions are answered.
    if (i % 3 != 0) continue;
    local_model::LocalModel told;
    ASSERT_TRUE(state->describe(0, told));
    const auto* const met = std::ranges::find_if(
        told.mass.contacts, [](const Contact& contact) { return !contact.met.mobility_per_kg.isZero(0); });
    // Until it slides, it has not hopped.
    if (!pushes || met == told.mass.contacts.end() || !(met->met.velocity_m_per_s.x() > 0.05)) continue;
    ++pushed;
    EXPECT_NEAR(met->met.dry_friction_N, dry_N, 0.1 * dry_N) << i << " ms";
    EXPECT_NEAR(met->met.bias_m_per_s2.z(), 0, 0.1) << i << " ms";
  }
  EXPECT_GT(pushed, 30);
}

TEST(DraggedBody, IsNothingIfItsJointsHoldIt) {
  Told told("", "");
  DraggedBody still{.body = told.dragged.body};
  EXPECT_FALSE(told.bodies.describe(*told.model, *told.data, still));
  Told held("<body name='other' pos='1 0 0'><freejoint/><geom size='0.01'/></body>", "");
  still.body = held.dragged.body;
  EXPECT_FALSE(held.bodies.describe(*held.model, *held.data, still)) << "though another one moves";
}

TEST(DraggedBody, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Told told(kCubeOnTable + wall_away(0.02, kX));
  const test::AllocationGuard guard;
  EXPECT_TRUE(told.bodies.describe(*told.model, *told.data, told.dragged));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(DraggedBody, DescribingChangesNothingOfTheMotion) {
  BodiesDescription description{.bodies = {floor_plate(), cube(0.1, {0, 0, 0.02}), cube(0.2, {0.05, 0.01, 0.02})}};
  description.bodies[2].name = "other";
  const auto world = [&] {
    ModelPointer model = compile_mjcf(to_mjcf(description, 1), "test");
    const int ball = mj_name2id(model.get(), mjOBJ_BODY, name_of_probe(0).c_str());
    const int slides = model->jnt_qposadr[model->body_jntadr[ball]];
    return std::make_unique<BodyWorld>(std::move(model), description.coupling,
                                       std::vector<BodyWorld::Probe>{{.body = ball, .slides = slides}});
  };
  const auto looks = world();
  const auto blind = world();
  Hand first(*looks);
  Hand second(*blind);
  local_model::LocalModel told;
  int pushed = 0;
  for (int i = 0; i < 2000; ++i) {
    const scene::Point at_m(-0.1 + 1e-4 * std::max(0, i - 600), 2e-3, 0.03);
    pushed += static_cast<int>(first.to(at_m).force_N.x() < -0.2);
    (void)second.to(at_m);
    (void)looks->describe(0, told);
    const int coordinates = looks->model().nq;
    ASSERT_TRUE(std::equal(looks->data().qpos, looks->data().qpos + coordinates, blind->data().qpos)) << i << " ms";
    ASSERT_TRUE(std::equal(looks->data().qvel, looks->data().qvel + looks->model().nv, blind->data().qvel)) << i;
  }
  EXPECT_GT(pushed, 100);
  EXPECT_GT(told.mass.contact_count, 0U);
}

TEST(DraggedBody, InStepsOfItsWorldIsWhereItIsNow) {
  BodiesDescription slow{.bodies = {floor_plate()}, .timestep_s = 2e-3};
  const BodyDynamicModel bodies(std::move(slow), "test");
  const auto state = bodies.make_state(1);
  Hand hand(*state);
  (void)hand.rest_at({0, 0, 0.04}, 600);
  (void)hand.along({0, 0, 0.04}, {0.05, 0, 0.04});  // at 0.1 m/s, until the ball follows as fast
  local_model::LocalModel before;
  ASSERT_TRUE(state->describe(0, before));
  for (int i = 1; i <= 4; ++i) {
    (void)hand.to({0.05 + 1e-4 * i, 0, 0.04});
    local_model::LocalModel told;
    ASSERT_TRUE(state->describe(0, told));
    EXPECT_NEAR(told.mass.place_m.x() - before.mass.place_m.x(), 1e-4, 1e-6);
    ASSERT_EQ(told.mass.contact_count, 1U);
    EXPECT_NEAR(told.mass.contacts[0].gap_m, 0.036, 1e-5) << "the floor";
    before = told;
  }
}

TEST(DraggedBody, IsNotToldBeforeTheCouplingHasReachedTheDevice) {
  const BodyDynamicModel soon({.bodies = {floor_plate()}}, "test");
  const auto begun = soon.make_state(1);
  (void)Hand(*begun).rest_at({0, 0, 0.1}, 100);
  local_model::LocalModel none;
  EXPECT_FALSE(begun->describe(0, none));
  EXPECT_TRUE(none.empty());
  EXPECT_TRUE(soon.facts().describes_itself);
}

}  // namespace
}  // namespace forcebound::server
