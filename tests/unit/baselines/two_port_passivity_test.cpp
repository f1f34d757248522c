#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/two_port_loop.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::TwoPortLoop;

constexpr const char* kTwoPortPassivity = "tdpa-2port";

TEST(TwoPortPassivity, DampsJustWhatTheServerHasNotTakenIn) {
  TwoPortLoop loop(kTwoPortPassivity, {}, test::nothing_there());
  // 0.1 m/s is 1e-4 m a tick: a force of 1 N along it gives 0.1 mJ a tick.
  loop.step(0, 0);
  EXPECT_NEAR(loop.step(1e-4, 1), 0, 1e-12) << "nothing was taken in, so nothing may flow";
  loop.bounder().receive(test::saying(1e-3, Vector()));
  int ticks_with_force = 0;
  for (int i = 2; i < 50; ++i) ticks_with_force += std::abs(loop.step(1e-4 * i, 1) - 1) < 1e-9;
  EXPECT_EQ(ticks_with_force, 10) << "1 mJ at 0.1 mJ a tick";
  EXPECT_NEAR(loop.energy_J(), 0, 1e-12);
}

TEST(TwoPortPassivity, AddsNoMoreDampingThanAlphaMax) {
  for (const double alpha_max : {0.0, 0.5, 1.0}) {
    TwoPortLoop loop(kTwoPortPassivity, {.parameters = {{"alpha_max_per_b", alpha_max}}}, test::nothing_there());
    loop.step(0, 0);
    EXPECT_NEAR(loop.step(1e-4, 5), 5 - alpha_max * 30 * 0.1, 1e-12);
  }
}

TEST(TwoPortPassivity, LeavesAForceAloneThatTakesEnergy) {
  TwoPortLoop loop(kTwoPortPassivity, {}, test::nothing_there());
  for (int i = 0; i < 100; ++i) ASSERT_EQ(loop.step(1e-5 * i, -2), -2);
  EXPECT_NEAR(loop.law().outgoing()[0], 99e-5 * 2, 1e-12) << "which travels to the server";
}

TEST(TwoPortPassivity, DoesNotActBelowTheVelocityFloor) {
  TwoPortLoop loop(kTwoPortPassivity, {.parameters = {{"velocity_floor_m_per_s", 0.2}}}, test::nothing_there());
  loop.step(0, 0);
  EXPECT_EQ(loop.step(1e-4, 5), 5);
}

// The server-side law gives the environment no more than the device took in, whatever it asks and answers.
TEST(TwoPortPassivity, TheServersHalfNeverGivesMoreThanTheDeviceTookIn) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const int dof : {1, 3}) {
    const auto server_side = shipped_laws().make_server_side(kTwoPortPassivity, dof);
    double taken_in_J = 5;  // from before
    const double base_J = taken_in_J;
    double given_J = 0;
    double dissipated_J = 0;
    Vector device = Vector::Zero(dof);
    Vector place;
    Vector force = Vector::Zero(dof);
    for (int i = 0; i < 20'000; ++i) {
      const Vector step = Vector::NullaryExpr(dof, [&] { return 1e-4 * normal(random); });
      device += step;
      taken_in_J += std::max(0.0, 1e-4 * normal(random));
      const Vector next = server_side->place({.position = device,
                                              .numbers = control::ServerLawNumbers::Constant(1, taken_in_J),
                                              .interval_s = i > 0 ? 1e-3 : 0});
      if (i == 0) {
        taken_in_J = base_J;
        EXPECT_EQ(next, device);
      } else {
        given_J += std::max(0.0, -force.dot(next - place));
        dissipated_J += -force.dot(step - (next - place));
        ASSERT_LE(given_J, taken_in_J - base_J + 1e-9) << i;
      }
      place = next;
      force = Vector::NullaryExpr(dof, [&] { return 3 * normal(random); });
      (void)server_side->answer(force);
    }
    EXPECT_GT(dissipated_J, 0.01) << "it had to act";
  }
}

double drift_m(std::size_t delay_ticks) {
  TwoPortLoop loop(kTwoPortPassivity, {.delay_ticks = delay_ticks}, test::wall_of(5000));
  double position_m = 0;
  for (int i = 0; i < 4000; ++i) {
    position_m = 3e-3 * std::sin(4e-3 * M_PI * i) - 1e-3;
    loop.tick(position_m);
  }
  for (int i = 0; i < 200; ++i) loop.tick(position_m);
  return std::abs(loop.place()[0] - position_m);
}

TEST(TwoPortPassivity, CostsADriftOfThePlaceThatGrowsWithTheDelay) {
  EXPECT_GT(drift_m(50), 1e-3);
  EXPECT_GT(drift_m(50), 2 * drift_m(0));
}

}  // namespace
}  // namespace forcebound::baselines
