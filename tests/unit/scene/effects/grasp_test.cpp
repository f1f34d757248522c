#include "forcebound/scene/effects/grasp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "forcebound/scene/registry.hpp"
#include "tests/support/effect_probe.hpp"

namespace forcebound::scene {
namespace {

constexpr double kHolds_N_per_m = 200;
const Point kPlace(0.01, -0.02, 0.03);

std::unique_ptr<Effect> grasp(double damping_N_s_per_m = 0, double force_N_max = 1e6) {
  return grasp_effect().make({{"button", 1.0},
                              {"stiffness_N_per_m", kHolds_N_per_m},
                              {"damping_N_s_per_m", damping_N_s_per_m},
                              {"radius_m", 0.0},
                              {"force_N_max", force_N_max}});
}

Probe at(const Point& position_m, std::uint32_t buttons, const Point& velocity_m_per_s = Point::Zero()) {
  return {.position_m = position_m, .velocity_m_per_s = velocity_m_per_s, .handle = {.buttons = buttons}};
}

TEST(Grasp, HoldsWhereItsButtonWasPressedUntilItIsLetGo) {
  const auto effect = grasp();
  test::EffectProbe felt(*effect);
  const Point aside = kPlace + Point(0.01, 0, 0);
  EXPECT_EQ(felt(at(kPlace, 0)).force_N, Point(0, 0, 0));
  EXPECT_EQ(felt(at(kPlace, 2)).force_N, Point(0, 0, 0)) << "begins without a force";
  EXPECT_LT((felt(at(aside, 2)).force_N - Point(-2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((felt(at(aside, 3)).force_N - Point(-2, 0, 0)).norm(), 1e-12) << "whatever else is pressed";
  EXPECT_EQ(felt(at(aside, 1)).force_N, Point(0, 0, 0)) << "let go";
  EXPECT_EQ(felt(at(aside, 2)).force_N, Point(0, 0, 0)) << "pressed anew, it holds there";
  EXPECT_LT((felt(at(kPlace, 2)).force_N - Point(2, 0, 0)).norm(), 1e-12);
}

TEST(Grasp, OfADeviceWithoutButtonsHoldsNothing) {
  const auto effect = grasp();
  test::EffectProbe felt(*effect);
  EXPECT_EQ(felt({.position_m = kPlace}).force_N, Point(0, 0, 0));
  EXPECT_EQ(felt({.position_m = 2 * kPlace}).force_N, Point(0, 0, 0));
}

TEST(Grasp, BeginsWithoutAForceHoweverFastTheDeviceIs) {
  EXPECT_EQ(test::force_N(*grasp(5), at(kPlace, 2, Point(1, 2, 3))), Point(0, 0, 0));
}

TEST(Grasp, PullsNoHarderThanTheMost) {
  const auto effect = grasp(0, 1.5);
  test::EffectProbe felt(*effect);
  (void)felt(at(kPlace, 2));
  EXPECT_NEAR(felt(at(kPlace + Point(0, 0, 1), 2)).force_N.z(), -1.5, 1e-12);
}

// The device moves on straight lines between motions, pressing and letting go at random. What it gets back never
// exceeds what it put in; the trapezoid is exact for the spring, whose force is linear on a line of no saturation.
TEST(Grasp, ReturnsNoMoreThanItTookHoweverTheButtonIsPressed) {
  std::mt19937 random(11);
  std::normal_distribution<double> step_m(0, 1e-4);
  std::bernoulli_distribution changes(0.01);
  const auto effect = grasp();
  test::EffectProbe felt(*effect);
  Point place_m = kPlace;
  Point force_N = Point::Zero();
  std::uint32_t buttons = 0;
  double taken_J = 0;
  double least_J = 0;
  double most_J = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Point moved_m(step_m(random), step_m(random), step_m(random));
    place_m += moved_m;
    // Up to the motion the button is as it was; then it changes at once.
    const Point before_N = felt(at(place_m, buttons)).force_N;
    taken_J -= 0.5 * (force_N + before_N).dot(moved_m);
    least_J = std::min(least_J, taken_J);
    most_J = std::max(most_J, taken_J);
    if (changes(random)) buttons ^= 2U;
    force_N = felt(at(place_m, buttons)).force_N;
  }
  EXPECT_GE(least_J, -1e-9);
  EXPECT_GT(most_J, 1e-4) << "there was something to give back";
}

}  // namespace
}  // namespace forcebound::scene
