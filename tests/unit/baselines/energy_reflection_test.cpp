// `tdpa-er`: the server sends back what it does not need, and its position follows the device without drift.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/two_port_loop.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::TwoPortLoop;

constexpr const char* kReflection = "tdpa-er";

TEST(EnergyReflection, IsTheTwoPortApproachAtTheDeviceAndTellsTheServerItsShare) {
  TwoPortLoop loop(kReflection, {.parameters = {{"reflected_share", 0.25}}}, test::nothing_there());
  TwoPortLoop two_port("tdpa-2port", {}, test::nothing_there());
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double received_J = 0;
  for (int i = 0; i < 1000; ++i) {
    received_J += 1e-4 * std::abs(normal(random));
    loop.bounder().receive(test::saying(received_J, Vector()));
    two_port.bounder().receive(test::saying(received_J, Vector()));
    const double position_m = 1e-3 * normal(random);
    const double request_N = normal(random);
    ASSERT_EQ(loop.step(position_m, request_N), two_port.step(position_m, request_N)) << i;
  }
  EXPECT_EQ(loop.law().outgoing()[0], two_port.law().outgoing()[0]);
  EXPECT_EQ(loop.law().outgoing()[1], 0.25);
}

/// The server-side law after a first motion at 0, answered by `force_N`.
std::unique_ptr<control::ServerSideLaw> begun_with(double force_N) {
  auto server_side = shipped_laws().make_server_side(kReflection, 1);
  const Vector start = Vector::Zero(1);
  (void)server_side->place({.position = start, .numbers = control::ServerLawNumbers::Zero(2), .interval_s = 0});
  (void)server_side->answer(Vector::Constant(1, force_N));
  return server_side;
}

Vector place_at(control::ServerSideLaw& server_side, double position_m, const Eigen::Vector2d& numbers) {
  const Vector position = Vector::Constant(1, position_m);
  return server_side.place({.position = position, .numbers = numbers, .interval_s = 1e-3});
}

TEST(EnergyReflection, ReflectsWhatIsNotUsed) {
  const auto server_side = begun_with(0);
  place_at(*server_side, 1e-3, {1e-3, 0.25});
  EXPECT_NEAR(server_side->answer(Vector::Zero(1)).numbers[0], 0.25e-3, 1e-15);
  place_at(*server_side, 2e-3, {1e-3, 0.25});
  EXPECT_NEAR(server_side->answer(Vector::Zero(1)).numbers[0], 0.4375e-3, 1e-15) << "a quarter of the rest";
}

TEST(EnergyReflection, StoresForAPositionThatIsBehind) {
  const auto server_side = begun_with(-10);
  EXPECT_NEAR(place_at(*server_side, 1e-3, {1e-3, 1})[0], 1e-4, 1e-15) << "10 mJ would be needed";
  EXPECT_EQ(server_side->answer(Vector::Constant(1, -10)).numbers[0], 0);
  EXPECT_NEAR(place_at(*server_side, 1e-3, {20e-3, 1})[0], 1e-3, 1e-15) << "it catches up";
  EXPECT_NEAR(server_side->answer(Vector::Constant(1, -10)).numbers[0], 10e-3, 1e-15);
}

TEST(EnergyReflection, SendsBackWhatTheEnvironmentReturns) {
  const auto server_side = begun_with(-10);
  EXPECT_EQ(place_at(*server_side, -1e-3, {0, 0})[0], -1e-3);
  EXPECT_NEAR(server_side->answer(Vector::Zero(1)).numbers[0], 10e-3, 1e-15);
}

// Neither the environment nor the device gets more than the other one gave, whatever is asked and answered.
TEST(EnergyReflection, TheServersHalfGeneratesNothing) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const int dof : {1, 3}) {
    const auto server_side = shipped_laws().make_server_side(kReflection, dof);
    double taken_in_J = 0;
    double given_J = 0;
    double returned_J = 0;
    double behind_m = 0;
    Vector device = Vector::Zero(dof);
    Vector place = device;
    Vector force = Vector::Zero(dof);
    control::ServerLawNumbers numbers(2);
    for (int i = 0; i < 20'000; ++i) {
      numbers << taken_in_J, 0.5;
      const Vector next = server_side->place({.position = device, .numbers = numbers, .interval_s = i > 0 ? 1e-3 : 0});
      const double into_J = -force.dot(next - place);
      (into_J > 0 ? given_J : returned_J) += std::abs(into_J);
      ASSERT_LE(given_J, taken_in_J + 1e-9) << i;
      behind_m = std::max(behind_m, (next - device).norm());
      place = next;
      force = Vector::NullaryExpr(dof, [&] { return 3 * normal(random); });
      const double back_J = server_side->answer(force).numbers[0];
      ASSERT_LE(back_J, taken_in_J - given_J + returned_J + 1e-9) << i;
      taken_in_J += std::max(0.0, 1e-4 * normal(random));
      device += Vector::NullaryExpr(dof, [&] { return 1e-4 * normal(random); });
    }
    EXPECT_GT(behind_m, 1e-4) << "it had to act";
  }
}

/// Mean force [N] of the eighth of slow taps, 5 mm deep into a wall that answers 100 ms late.
double eighth_tap_N(const char* law) {
  constexpr int kTap = 2000;
  TwoPortLoop loop(law, {.delay_ticks = 50}, test::wall_of(5000));
  double sum_N = 0;
  for (int i = 0; i < 8 * kTap; ++i) {
    const double force_N = loop.tick(5e-3 * std::sin(2 * M_PI * i / kTap));
    if (i >= 7 * kTap) sum_N -= force_N;
  }
  return sum_N / kTap;
}

TEST(EnergyReflection, StillShowsAWallFromWhichTheTwoPortApproachHasDrifted) {
  EXPECT_GT(eighth_tap_N(kReflection), 1);
  EXPECT_LT(eighth_tap_N("tdpa-2port"), 1e-3);
}

TEST(EnergyReflection, LeavesNoDrift) {
  for (const std::size_t delay_ticks : {0U, 50U}) {
    TwoPortLoop loop(kReflection, {.delay_ticks = delay_ticks}, test::wall_of(5000));
    double position_m = 0;
    for (int i = 0; i < 4000; ++i) {
      position_m = 3e-3 * std::sin(4e-3 * M_PI * i) - 1e-3;
      loop.tick(position_m);
    }
    for (int i = 0; i < 200; ++i) loop.tick(position_m);
    EXPECT_NEAR(loop.place()[0], position_m, 1e-15) << delay_ticks;
  }
}

}  // namespace
}  // namespace forcebound::baselines
