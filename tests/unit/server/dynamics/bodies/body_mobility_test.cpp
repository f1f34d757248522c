#include "forcebound/server/dynamics/bodies/body_mobility.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr double kMuJoCosGravity = 9.81;
const scene::Point kAnyWay = scene::Point::Zero();
const scene::Point kUnpushed = scene::Point::Zero();

/// Bodies of MJCF at rest, and how they move.
struct Movable {
  ModelPointer model;
  DataPointer data;
  BodyMobility mobility;

  explicit Movable(const std::string& bodies, const std::string& more = "")
      : model(compile_mjcf(
            "<mujoco><option timestep='0.001'/><worldbody>" + bodies + "</worldbody>" + more + "</mujoco>", "m.xml")),
        data(make_data(*model)),
        mobility(*model) {
    forward(*model, *data);
  }

  void settle() {
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(step(*model, *data));
    forward(*model, *data);
  }
  [[nodiscard]] BodyMobility::Contacts all(const std::array<int, 2>& but_of = {-1, -1}) const {
    return {.contacts = {data->contact, static_cast<std::size_t>(data->ncon)}, .but_of = but_of};
  }
  [[nodiscard]] int id(const char* body) const { return mj_name2id(model.get(), mjOBJ_BODY, body); }
  /// At its centre of mass.
  std::optional<local_model::Body> answer(const char* body, const scene::Point& direction,
                                          const scene::Point& pushed_N = kUnpushed) {
    const scene::Point at_m = Eigen::Map<const scene::Point>(data->xipos + 3 * id(body));
    return mobility.answer(*model, *data, id(body), at_m, direction, pushed_N);
  }
  local_model::Body answer_with(const BodyMobility::Contacts& contacts, const char* body, const scene::Point& direction,
                                const scene::Point& pushed_N = kUnpushed) {
    EXPECT_TRUE(mobility.consider(*model, *data, contacts));
    const auto found = answer(body, direction, pushed_N);
    EXPECT_TRUE(found);
    return found.value_or(local_model::Body{});
  }
};

constexpr double kLower_kg = 0.2;
constexpr double kUpper_kg = 0.3;
constexpr double kTableFriction = 0.4;

/// A box of 40 mm on a table, or two, one upon the other.
std::string boxes_on_a_table(int boxes) {
  const std::string box = "<freejoint/><geom type='box' size='0.02 0.02 0.02' friction='0.4' mass='";
  std::string text = "<geom type='plane' size='1 1 1' friction='0.4'/>";
  text += "<body name='lower' pos='0 0 0.02'>" + box + std::to_string(kLower_kg) + "'/></body>";
  if (boxes > 1) text += "<body name='upper' pos='0 0 0.06'>" + box + std::to_string(kUpper_kg) + "'/></body>";
  return text;
}

TEST(BodyMobility, OfAFreeBodyIsOneOverItsMassAndItFallsAsItGoes) {
  Movable free("<body name='b'><freejoint/><inertial pos='0.1 0.2 0.3' mass='0.7' diaginertia='1 2 2.5'/></body>");
  const scene::Point velocity_m_per_s(0.1, -0.2, 0.3);
  Eigen::Map<scene::Point>(free.data->qvel) = velocity_m_per_s;
  forward(*free.model, *free.data);
  const local_model::Body body = free.answer_with({}, "b", kAnyWay);
  EXPECT_TRUE(body.mobility_per_kg.isApprox(Eigen::Matrix3d::Identity() / 0.7, 1e-12));
  EXPECT_LT((body.velocity_m_per_s - velocity_m_per_s).norm(), 1e-12);
  EXPECT_LT((body.bias_m_per_s2 - scene::Point(0, 0, -kMuJoCosGravity)).norm(), 1e-9);
  EXPECT_EQ(body.spring_N_per_m, 0);
  EXPECT_EQ(body.damper_N_s_per_m, 0);
  EXPECT_EQ(body.dry_friction_N, 0);
}

TEST(BodyMobility, OfABodyOnATableIsNoneAlongTheNormalAndAllBesideIt) {
  Movable table(boxes_on_a_table(1));
  table.settle();
  const local_model::Body body = table.answer_with(table.all(), "lower", scene::Point::UnitX());
  EXPECT_LT(body.mobility_per_kg.col(2).norm() * kLower_kg, 1e-3);
  EXPECT_NEAR(body.mobility_per_kg(0, 0) * kLower_kg, 1, 1e-3);
  EXPECT_NEAR(body.mobility_per_kg(1, 1) * kLower_kg, 1, 1e-3);
  EXPECT_LT(body.bias_m_per_s2.norm(), 1e-3 * kMuJoCosGravity) << "the table bears its weight";
}

TEST(BodyMobility, CountsNoContactOrNotThoseOfSomeBodies) {
  Movable table(boxes_on_a_table(2));
  table.settle();
  const auto up_per_kg = [&](const BodyMobility::Contacts& contacts) {
    return table.answer_with(contacts, "lower", kAnyWay).mobility_per_kg(2, 2);
  };
  EXPECT_NEAR(up_per_kg({}) * kLower_kg, 1, 1e-9);
  EXPECT_NEAR(up_per_kg(table.all({-1, table.id("lower")})) * kLower_kg, 1, 1e-9);
  EXPECT_LT(up_per_kg(table.all({table.id("upper"), -1})) * kLower_kg, 1e-3);
}

TEST(BodyMobility, CarriesAlongWhatStandsUponIt) {
  Movable stack(boxes_on_a_table(2));
  stack.settle();
  const double along_per_kg = stack.answer_with(stack.all(), "lower", scene::Point::UnitX()).mobility_per_kg(0, 0);
  // Pushed in the middle of the lower one, the upper one could tilt about its edge, but for the contacts' normals.
  EXPECT_NEAR(along_per_kg * (kLower_kg + kUpper_kg), 1, 0.01);
}

TEST(BodyMobility, AButtonHasTheSpringAndTheDamperOfItsJoint) {
  Movable button(R"(<body name="cap"><joint type="slide" axis="0 0 1" stiffness="400" damping="1.5"/>
      <geom size="0.01" mass="0.03"/></body>)");
  button.data->qpos[0] = -0.002;
  button.data->qvel[0] = -0.1;
  forward(*button.model, *button.data);
  const local_model::Body body = button.answer_with({}, "cap", -scene::Point::UnitZ());
  EXPECT_NEAR(body.spring_N_per_m, 400, 1e-9);
  EXPECT_NEAR(body.damper_N_s_per_m, 1.5, 1e-9);
  const scene::Point up = scene::Point::UnitZ();
  EXPECT_LT((body.mobility_per_kg - up * up.transpose() / 0.03).norm(), 1e-9) << "it goes along its joint alone";
  EXPECT_NEAR(body.velocity_m_per_s.z(), -0.1, 1e-12);
  EXPECT_NEAR(body.bias_m_per_s2.z(), 400 * 0.002 / 0.03 - kMuJoCosGravity, 1e-9) << "the spring, not the damper";
}

// A door of 1 kg whose centre is 0.1 m from its hinge: with its own 0.01 kg m^2 it has 0.02 about that.
constexpr const char* kHinged = R"(<body name="door"><joint type="hinge" axis="0 0 1" stiffness="3" damping="0.2"
    frictionloss="0.5" limited="true" range="-30 60"/><inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body>)";
constexpr double kAboutHinge_kg_m2 = 0.02;

TEST(BodyMobility, AHingeShowsItsNumbersAtTheLeverOfThePoint) {
  for (const double lever_m : {0.05, 0.4}) {
    Movable hinged(kHinged);
    ASSERT_TRUE(hinged.mobility.consider(*hinged.model, *hinged.data, {}));
    const auto body =
        hinged.mobility.answer(*hinged.model, *hinged.data, hinged.id("door"), {lever_m, 0, 0}, kAnyWay, kUnpushed);
    ASSERT_TRUE(body);
    EXPECT_NEAR(body->mobility_per_kg(1, 1), lever_m * lever_m / kAboutHinge_kg_m2, 1e-9) << lever_m;
    EXPECT_LT(body->mobility_per_kg.col(0).norm(), 1e-12) << "along the arm nothing moves";
    EXPECT_NEAR(body->spring_N_per_m, 3 / (lever_m * lever_m), 1e-6);
    EXPECT_NEAR(body->damper_N_s_per_m, 0.2 / (lever_m * lever_m), 1e-6);
    EXPECT_NEAR(body->dry_friction_N, 0.5 / lever_m, 1e-6) << "its frictionloss";
  }
}

TEST(BodyMobility, AWeldCarriesWhatIsHeld) {
  constexpr double kRadius_m = 0.02;
  constexpr double kBetween_m = 0.1;
  constexpr double kFirst_kg = 0.2;
  constexpr double kSecond_kg = 0.6;
  Movable welded(
      R"(<body name="first"><freejoint/><geom size="0.02" mass="0.2"/></body>
         <body name="second" pos="0.1 0 0"><freejoint/><geom size="0.02" mass="0.6"/></body>)",
      "<equality><weld body1='first' body2='second'/></equality>");
  const local_model::Body body = welded.answer_with({}, "first", kAnyWay);
  constexpr double kBoth_kg = kFirst_kg + kSecond_kg;
  constexpr double kFromMiddle_m = kBetween_m * kSecond_kg / kBoth_kg;
  constexpr double kInertia_kg_m2 =
      0.4 * kBoth_kg * kRadius_m * kRadius_m + kFirst_kg * kSecond_kg / kBoth_kg * kBetween_m * kBetween_m;
  constexpr double kAcross_per_kg = 1 / kBoth_kg + kFromMiddle_m * kFromMiddle_m / kInertia_kg_m2;
  EXPECT_NEAR(body.mobility_per_kg(0, 0) * kBoth_kg, 1, 0.01);
  EXPECT_NEAR(body.mobility_per_kg(1, 1) / kAcross_per_kg, 1, 0.01);
}

TEST(BodyMobility, DryFrictionOnATableIsThatOfTheWeightOfAllThatItBears) {
  for (const int boxes : {1, 2}) {
    Movable table(boxes_on_a_table(boxes));
    table.settle();
    const double weight_N = kMuJoCosGravity * (boxes == 1 ? kLower_kg : kLower_kg + kUpper_kg);
    const auto friction_N = [&](const scene::Point& direction, const scene::Point& pushed_N) {
      return table.answer_with(table.all(), "lower", direction, pushed_N).dry_friction_N;
    };
    EXPECT_NEAR(friction_N(scene::Point::UnitX(), kUnpushed), kTableFriction * weight_N, 0.01 * weight_N) << boxes;
    EXPECT_NEAR(friction_N(-scene::Point::UnitY(), kUnpushed), kTableFriction * weight_N, 0.01 * weight_N) << boxes;
    EXPECT_NEAR(friction_N(scene::Point::UnitX(), {0, 0, -5}), kTableFriction * (weight_N + 5), 0.01 * weight_N + 0.05);
    EXPECT_EQ(friction_N(scene::Point::UnitX(), {0, 0, 2 * weight_N}), 0) << "pulled up";
    EXPECT_EQ(table.answer_with({}, "lower", scene::Point::UnitX()).dry_friction_N, 0) << "no contact counts";
  }
}

TEST(BodyMobility, LimitsOfJointsAreRoom) {
  Movable slide(R"(<body name="b"><joint type="slide" axis="1 0 0" limited="true" range="-0.01 0.03"/>
      <geom size="0.01" mass="0.1"/></body>)");
  slide.data->qpos[0] = 0.01;
  forward(*slide.model, *slide.data);
  (void)slide.answer_with({}, "b", scene::Point::UnitX());
  BodyMobility::Room room = slide.mobility.room_of_joints_m(*slide.model, *slide.data);
  EXPECT_EQ(room.way, scene::Point(scene::Point::UnitX()));
  EXPECT_NEAR(room.along_m, 0.02, 1e-12);
  EXPECT_NEAR(room.against_m, 0.02, 1e-12);
  slide.data->qpos[0] = 0.025;
  forward(*slide.model, *slide.data);
  (void)slide.answer_with({}, "b", -scene::Point::UnitX());
  room = slide.mobility.room_of_joints_m(*slide.model, *slide.data);
  EXPECT_NEAR(room.along_m, 0.035, 1e-12);
  EXPECT_NEAR(room.against_m, 0.005, 1e-12);
  slide.data->qpos[0] = 0.031;
  forward(*slide.model, *slide.data);
  EXPECT_EQ(slide.mobility.room_of_joints_m(*slide.model, *slide.data).against_m, 0) << "in its stop";
}

TEST(BodyMobility, RoomOfAHingeIsAtTheLeverOfThePoint) {
  Movable hinged(kHinged);
  ASSERT_TRUE(hinged.mobility.consider(*hinged.model, *hinged.data, {}));
  const auto room = [&](const scene::Point& direction) {
    EXPECT_TRUE(
        hinged.mobility.answer(*hinged.model, *hinged.data, hinged.id("door"), {0.4, 0, 0}, direction, kUnpushed));
    return hinged.mobility.room_of_joints_m(*hinged.model, *hinged.data);
  };
  EXPECT_NEAR(room(scene::Point::UnitY()).along_m, 0.4 * std::numbers::pi / 3, 1e-9);
  EXPECT_NEAR(room(scene::Point::UnitY()).against_m, 0.4 * std::numbers::pi / 6, 1e-9);
  EXPECT_EQ(room(scene::Point::UnitX()).way, scene::Point(scene::Point::Zero())) << "nothing moves it along its arm";
  EXPECT_EQ(room(scene::Point::UnitX()).along_m, kUnlimited);
}

TEST(BodyMobility, RoomOfAFreeBodyHasNoEnd) {
  Movable free("<body name='b'><freejoint/><geom size='0.1'/></body>");
  (void)free.answer_with({}, "b", scene::Point::UnitZ());
  const BodyMobility::Room room = free.mobility.room_of_joints_m(*free.model, *free.data);
  EXPECT_EQ(room.along_m, kUnlimited);
  EXPECT_EQ(room.against_m, kUnlimited);
}

TEST(BodyMobility, SaysWhatCannotBeSolved) {
  Movable still("<geom size='0.1'/>");
  EXPECT_FALSE(BodyMobility::can_do(*still.model));
  EXPECT_FALSE(still.mobility.consider(*still.model, *still.data, {}));
  EXPECT_EQ(BodyMobility::predicted_cost_ns(*still.model), 0);

  std::string many;
  for (int i = 0; i < 11; ++i) {
    many += "<body pos='" + std::to_string(i) + " 0 0'><freejoint/><geom size='0.1'/></body>";
  }
  Movable too_many(many);
  EXPECT_FALSE(BodyMobility::can_do(*too_many.model)) << "66 degrees of freedom";
  EXPECT_FALSE(too_many.mobility.consider(*too_many.model, *too_many.data, {}));

  const std::string along = "<joint type='slide' axis='1 0 0'/><inertial pos='0 0 0' diaginertia='1 1 1' mass='";
  Movable unequal("<body>" + along + "1000'/></body><body pos='1 0 0'>" + along + "1e-10'/></body>");
  EXPECT_FALSE(unequal.mobility.consider(*unequal.model, *unequal.data, {})) << "1e-13 of the largest inertia";

  Movable broken("<body name='b'><freejoint/><geom size='0.1'/></body>");
  ASSERT_TRUE(broken.mobility.consider(*broken.model, *broken.data, {}));
  EXPECT_TRUE(broken.answer("b", kAnyWay));
  broken.data->qfrc_smooth[0] = std::nan("");
  EXPECT_FALSE(broken.answer("b", kAnyWay));
}

TEST(BodyMobility, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Movable stack(boxes_on_a_table(2));
  stack.settle();
  const test::AllocationGuard guard;
  EXPECT_TRUE(stack.mobility.consider(*stack.model, *stack.data, stack.all()));
  EXPECT_TRUE(stack.answer("lower", scene::Point::UnitX(), {0, 0, -1}));
  EXPECT_EQ(stack.mobility.room_of_joints_m(*stack.model, *stack.data).along_m, kUnlimited);
  EXPECT_EQ(travel_m(*stack.model, *stack.data, stack.id("lower"), scene::Point::UnitX()), kUnlimited);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
