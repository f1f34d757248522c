#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/two_port_loop.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::TwoPortLoop;

constexpr const char* kTwoLayer = "tla";

/// A tank that neither sends nor is filled, so that a test sets its level.
TwoPortLoop alone() {
  return TwoPortLoop(kTwoLayer, {.parameters = {{"beta", 0}, {"filling_N_s_per_m", 0}}}, test::nothing_there());
}

TEST(TwoLayer, GivesNoForceFromAnEmptyTank) {
  TwoPortLoop loop = alone();
  for (int i = 0; i < 100; ++i) ASSERT_EQ(loop.step(1e-4 * i, i % 2 == 0 ? 5 : -5), 0) << i;
}

TEST(TwoLayer, GivesAllThatTheTankHoldsAndNoMore) {
  TwoPortLoop loop = alone();
  loop.step(0, 0);
  loop.bounder().receive(test::saying(1.05e-3, Vector()));
  double given_J = 0;
  double force_N = 0;
  for (int i = 1; i < 100; ++i) {
    given_J += force_N * 1e-4;
    force_N = loop.step(1e-4 * i, 1);
    ASSERT_GE(loop.energy_J(), -1e-15) << i;
  }
  EXPECT_NEAR(given_J, 1.05e-3, 1e-12);
  EXPECT_NEAR(force_N, 0, 1e-9);
}

TEST(TwoLayer, FillsTheTankWithDampingUpToTheLevelDesired) {
  TwoPortLoop loop(kTwoLayer, {.parameters = {{"beta", 0}, {"desired_J", 1e-3}}}, test::nothing_there());
  EXPECT_EQ(loop.step(0, 0), 0);
  EXPECT_NEAR(loop.step(1e-4, 0), -30 * 0.1, 1e-12) << "an empty tank asks for b";
  double before_J = loop.energy_J();
  for (int i = 2; i < 500; ++i) {
    loop.step(1e-4 * i, 0);
    ASSERT_GE(loop.energy_J(), before_J);
    before_J = loop.energy_J();
  }
  EXPECT_NEAR(before_J, 1e-3, 1e-4);
}

TEST(TwoLayer, SendsAShareOfItsTankAndKeepsTheRest) {
  TwoPortLoop loop(kTwoLayer, {.parameters = {{"beta", 0.25}, {"filling_N_s_per_m", 0}}}, test::nothing_there());
  loop.step(0, 0);
  loop.bounder().receive(test::saying(1e-3, Vector()));
  for (int i = 0; i < 3; ++i) {
    loop.step(0, 0);
    EXPECT_NEAR(loop.energy_J() + loop.law().outgoing()[0], 1e-3, 1e-15);
  }
  EXPECT_NEAR(loop.energy_J(), 1e-3 * std::pow(0.75, 3), 1e-15);
}

TEST(TwoLayer, TheServersPlaceGoesNoDeeperThanItsTankPaysAndCatchesUp) {
  const auto server_side = shipped_laws().make_server_side(kTwoLayer, 1);
  const auto place_at = [&](double x_m, double sent_J) {
    control::ServerLawNumbers numbers(2);
    numbers << sent_J, 0.0;
    return server_side->place({.position = Vector::Constant(1, x_m), .numbers = numbers, .interval_s = 1e-3})[0];
  };
  EXPECT_EQ(place_at(0, 7), 0) << "the first sum received is its start";
  (void)server_side->answer(Vector::Constant(1, -10));
  EXPECT_NEAR(place_at(1e-3, 7), 0, 1e-15);
  EXPECT_NEAR(place_at(1e-3, 7.002), 2e-4, 1e-12) << "2 mJ against 10 N";
  EXPECT_NEAR(place_at(1e-3, 7.002), 2e-4, 1e-12) << "once";
  EXPECT_NEAR(place_at(1e-3, 7.1), 1e-3, 1e-12);
  EXPECT_NEAR(place_at(5e-4, 7.1), 5e-4, 1e-12) << "the environment pushes back and fills the tank";
}

}  // namespace
}  // namespace forcebound::baselines
