// The shipped scene "assembly", with a scripted hand.

#include <gtest/gtest.h>

#include <algorithm>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {
namespace {

constexpr double kDeviceForce_N_max = 3.3;
constexpr double kCoupling_N_per_m = 300;
constexpr double kWeight_N = 0.06 * 9.81;

struct Push {
  scene::Point force_N;  ///< at the end, on the device
  double force_N_max = 0;

  /// Height of the peg above the hand.
  [[nodiscard]] double peg_above_hand_m() const { return force_N.z() / kCoupling_N_per_m; }
};

/// From the peg's start the hand goes aside in a second, down in two, and waits one.
Push push_down(double beside_m, double to_m) {
  scene::SceneState state(load_scene("assembly"), 3);
  constexpr double kStart_m = 0.05;
  Push push;
  for (int i = 0; i < 4000; ++i) {
    const double aside = std::min(i / 1000.0, 1.0);
    const double way = std::clamp((i - 1000) / 2000.0, 0.0, 1.0);
    const scene::Point hand_m(aside * beside_m, 0, kStart_m + way * (to_m - kStart_m));
    push.force_N = state.answer(control::Vector(hand_m), std::chrono::milliseconds(i)).force;
    push.force_N_max = std::max(push.force_N_max, push.force_N.norm());
  }
  EXPECT_EQ(state.faults().quarantined, 0U);
  return push;
}

TEST(Assembly, ThePegGoesInWhereTheHandIsAlignedAndItsWeightIsFelt) {
  const Push push = push_down(0, -0.01);
  EXPECT_NEAR(push.force_N.z(), -kWeight_N, 0.01);
  EXPECT_LT(push.force_N_max, 1.0);
}

TEST(Assembly, ThePegFindsTheHoleFromAMillimetreBeside) {
  const Push push = push_down(0.0015, -0.01);
  EXPECT_NEAR(push.force_N.z(), -kWeight_N, 0.3);
  EXPECT_LT(push.force_N_max, kDeviceForce_N_max);
}

TEST(Assembly, ThePegStopsOnTheBlockWhereTheHandIsNotAligned) {
  // The tip's lowest point is 20 mm below the peg's center of mass, the hand 10 mm above the block.
  const Push push = push_down(0.015, 0.01);
  EXPECT_NEAR(push.peg_above_hand_m(), 0.01, 1e-3);
  EXPECT_LT(push.force_N_max, kDeviceForce_N_max);
}

TEST(Assembly, ThePegStopsAtTheBottomOfTheHole) {
  const Push push = push_down(0, -0.03);
  EXPECT_NEAR(push.peg_above_hand_m(), 0.01, 1e-3);
}

}  // namespace
}  // namespace forcebound::server
