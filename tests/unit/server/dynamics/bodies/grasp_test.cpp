// A probe that takes hold of a body while a button is pressed.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/body_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/dynamics/bodies/hand.hpp"

namespace forcebound::server {
namespace {

constexpr double kGrasped_kg = 0.1;
constexpr double kProbe_kg = 0.03;
constexpr double kG_m_per_s2 = 9.80665;
constexpr std::uint32_t kGraspButton = 4;  // number 2
const scene::Point kAboveCube(0, 0, 0.06);
const scene::Point kPressingCube(0, 0, 0.041);

/// A cube of 40 mm on a floor, and a hand that comes down on it.
class GraspedCube : public testing::Test {
 protected:
  BodyWorld& begin(double force_N_max = 10) {
    BodiesDescription all;
    all.bodies = {floor_plate(), cube(kGrasped_kg, {0, 0, 0.02})};
    all.grasp = {.button = 2, .force_N_max = force_N_max};
    model.emplace(all, "test");
    state = model->make_state(2);
    hand.emplace(*state);
    hand->rest_at(kAboveCube, 600);
    return dynamic_cast<BodyWorld&>(*state);
  }
  void come_down() {
    hand->along(kAboveCube, kPressingCube);
    hand->rest_at(kPressingCube, 200);
  }
  void press(std::uint32_t buttons) { state->press(0, buttons); }
  /// The cube's middle, and how it is turned.
  [[nodiscard]] scene::Point cube_m() { return Eigen::Map<const scene::Point>(data().xpos + 3 * cube_id()); }
  [[nodiscard]] double turn() { return 1 - std::abs(data().xquat[4 * cube_id()]); }
  [[nodiscard]] int cube_id() { return mj_name2id(&world().model(), mjOBJ_BODY, "cube"); }
  [[nodiscard]] BodyWorld& world() { return dynamic_cast<BodyWorld&>(*state); }
  [[nodiscard]] const mjData_& data() { return world().data(); }

  std::optional<BodyDynamicModel> model;
  std::unique_ptr<scene::DynamicModelState> state;
  std::optional<Hand> hand;
};

TEST_F(GraspedCube, ComesAlongWhileTheButtonIsPressedAndFallsWhenItIsLetGo) {
  begin();
  come_down();
  press(kGraspButton);
  hand->along(kPressingCube, {0, 0, 0.12});
  const scene::ModelTouch lifted = hand->rest_at({0, 0, 0.12}, 500);
  EXPECT_NEAR(lifted.force_N.z(), -kGrasped_kg * kG_m_per_s2, 0.02) << "its weight is felt, the ball's is not";
  EXPECT_GT(lifted.penetration_m, 0);
  EXPECT_GT(cube_m().z(), 0.08);
  EXPECT_LT(turn(), 1e-6);
  hand->along({0, 0, 0.12}, {0.05, 0.03, 0.12});
  hand->rest_at({0.05, 0.03, 0.12}, 300);
  EXPECT_LT((cube_m().head<2>() - Eigen::Vector2d(0.05, 0.03)).norm(), 1e-3);
  EXPECT_LT(turn(), 1e-4) << "carried aside by its top, it does not swing";
  press(0);
  const scene::ModelTouch free = hand->rest_at({0.05, 0.03, 0.12}, 500);
  EXPECT_LT(free.force_N.norm(), 0.01);
  EXPECT_NEAR(cube_m().z(), 0.02, 1e-3) << "on the floor again";
}

TEST_F(GraspedCube, WithoutItsButtonIsOnlyPushed) {
  begin();
  come_down();
  press(kGraspButton ^ ~0U);
  hand->along(kPressingCube, kAboveCube);
  EXPECT_NEAR(cube_m().z(), 0.02, 1e-3);
  EXPECT_EQ(world().held_by(0), -1);
}

TEST_F(GraspedCube, IsTakenWhereItIsTouchedWithoutAJump) {
  begin();
  come_down();
  const scene::ModelTouch before = hand->rest_at(kPressingCube, 1);
  press(kGraspButton);
  for (int i = 0; i < 20; ++i) {
    const scene::ModelTouch touch = hand->rest_at(kPressingCube, 1);
    ASSERT_LT((touch.force_N - before.force_N).norm(), 0.02) << i << " ms after the press";
  }
  EXPECT_EQ(world().held_by(0), cube_id());
}

TEST_F(GraspedCube, SlipsOutOfAHoldThatCarriesTooMuchAndIsTakenAgainOnlyWhenPressedAnew) {
  begin(0.5);  // half of the cube's weight
  come_down();
  press(kGraspButton);
  hand->along(kPressingCube, kAboveCube);
  hand->rest_at(kAboveCube, 300);
  EXPECT_EQ(world().held_by(0), -1);
  EXPECT_NEAR(cube_m().z(), 0.02, 1e-3);
  come_down();
  EXPECT_EQ(world().held_by(0), -1) << "still the same press";
  press(0);
  hand->rest_at(kPressingCube, 1);
  press(kGraspButton);
  hand->rest_at(kPressingCube, 5);
  EXPECT_EQ(world().held_by(0), cube_id());
}

TEST_F(GraspedCube, TheFloorIsNotTaken) {
  begin();
  press(kGraspButton);
  hand->along(kAboveCube, {0.1, 0, 0.06});
  hand->along({0.1, 0, 0.06}, {0.1, 0, 0});
  hand->rest_at({0.1, 0, 0}, 100);
  EXPECT_EQ(world().held_by(0), -1);
}

TEST_F(GraspedCube, AProbeThatLeavesLetsGo) {
  begin();
  come_down();
  press(kGraspButton);
  hand->along(kPressingCube, kAboveCube);
  ASSERT_EQ(world().held_by(0), cube_id());
  state->leave(0);
  for (int i = 0; i < 500; ++i) state->advance(1e-3);
  EXPECT_NEAR(cube_m().z(), 0.02, 1e-3);
  EXPECT_EQ(state->join(), 0);
  EXPECT_EQ(world().held_by(0), -1);
}

TEST_F(GraspedCube, IsTheMassOfBothInTheLocalModelWhateverWayItIsPulled) {
  begin();
  come_down();
  press(kGraspButton);
  hand->along(kPressingCube, {0, 0, 0.12});
  hand->rest_at({0, 0, 0.12}, 500);
  local_model::LocalModel told;
  ASSERT_TRUE(state->describe(0, told));
  ASSERT_TRUE(told.has_mass);
  EXPECT_TRUE(local_model::is_sound(told));
  const double both_kg = kGrasped_kg + kProbe_kg;
  EXPECT_TRUE((both_kg * told.mass.body.mobility_per_kg).isApprox(Eigen::Matrix3d::Identity(), 0.05));
  EXPECT_NEAR(told.mass.body.bias_m_per_s2.z(), -kGrasped_kg * kG_m_per_s2 / both_kg, 0.3);
}

TEST_F(GraspedCube, ThatStandsOnTheFloorCanBeLiftedInTheLocalModelAndNotPressedDown) {
  begin();
  come_down();
  press(kGraspButton);
  hand->rest_at(kPressingCube, 200);
  local_model::LocalModel told;
  ASSERT_TRUE(state->describe(0, told));
  const local_model::Mass& mass = told.mass;
  // Nothing but the hand holds it up once it leaves the floor.
  constexpr double kBoth_kg = kGrasped_kg + kProbe_kg;
  EXPECT_NEAR(kBoth_kg * mass.body.mobility_per_kg(2, 2), 1, 0.05);
  EXPECT_NEAR(mass.body.bias_m_per_s2.z(), -kGrasped_kg * kG_m_per_s2 / kBoth_kg, 0.3);
  ASSERT_EQ(mass.contact_count, 1U) << "of what is held with the floor alone, at its four corners";
  EXPECT_LT((mass.contacts[0].normal - scene::Point::UnitZ()).norm(), 1e-6);
  EXPECT_LT(mass.contacts[0].gap_m, 0);
  EXPECT_TRUE(mass.contacts[0].met.mobility_per_kg.isZero(0));
}

TEST_F(GraspedCube, GoesOnInACopyAsInTheOriginal) {
  begin();
  come_down();
  press(kGraspButton);
  hand->along(kPressingCube, kAboveCube);
  const auto other = model->make_state(2);
  ASSERT_TRUE(other->copy_from(*state));
  for (int i = 0; i < 300; ++i) {
    for (auto* const one : {state.get(), other.get()}) {
      if (i == 200) one->press(0, 0);
      one->move(0, kAboveCube, scene::Point::Zero());
      one->advance(1e-3);
    }
    ASSERT_EQ(state->touch(0).force_N, other->touch(0).force_N) << i;
  }
  EXPECT_LT(cube_m().z(), 0.05) << "let go, it fell";
}

TEST_F(GraspedCube, TakingHoldAndLettingGoDoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  begin();
  come_down();
  hand->rest_at(kPressingCube, 5);
  const test::AllocationGuard guard;
  press(kGraspButton);
  hand->rest_at(kPressingCube, 5);
  local_model::LocalModel told;
  (void)state->describe(0, told);
  press(0);
  hand->rest_at(kPressingCube, 5);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(GraspedByNone, AWorldHasNoWeld) {
  BodiesDescription all;
  all.bodies = {floor_plate(), cube(kGrasped_kg, {0, 0, 0.02})};
  EXPECT_EQ(to_mjcf(all, 1).find("weld"), std::string::npos);
  all.grasp = GraspDescription{};
  EXPECT_NE(to_mjcf(all, 1).find("weld"), std::string::npos);
}

}  // namespace
}  // namespace forcebound::server
