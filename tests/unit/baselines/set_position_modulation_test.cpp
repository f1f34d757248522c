#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/two_port_loop.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::TwoPortLoop;

constexpr const char* kSetPositionModulation = "pspm";
constexpr double kSpring_N_per_m = 30e3;  // half of 2b/T

control::ServerLawNumbers reply(double energy_J, double place_m) {
  return test::saying(energy_J, Vector::Constant(1, place_m));
}

TEST(SetPositionModulation, ReachesAsFarAsTheEnergyPays) {
  for (const double toward : {1.0, -1.0}) {
    TwoPortLoop loop(kSetPositionModulation, {}, test::nothing_there());
    loop.step(0, 0);
    loop.bounder().receive(reply(2e-3, 0.01 * toward));
    const double reach_m = std::sqrt(2 * 2e-3 / kSpring_N_per_m);
    EXPECT_NEAR(loop.step(0, 0), kSpring_N_per_m * reach_m * toward, 1e-9);
    EXPECT_NEAR(loop.energy_J(), 0, 1e-15);
  }
}

TEST(SetPositionModulation, IsTheSpringThatIsAskedForWhileEnergyLasts) {
  TwoPortLoop loop(kSetPositionModulation, {}, test::nothing_there());
  loop.step(0, 0);
  loop.bounder().receive(reply(2e-3, 1e-4));
  // y = x_s + f_e/Kp
  EXPECT_NEAR(loop.step(0, -6), kSpring_N_per_m * 1e-4 - 6, 1e-9);
  EXPECT_NEAR(loop.energy_J(), 2e-3 - 9 / (2 * kSpring_N_per_m), 1e-12);
}

TEST(SetPositionModulation, GainsFromMotionWhatTheDeviceMustHaveDissipated) {
  TwoPortLoop loop(kSetPositionModulation, {.parameters = {{"damping_share", 0.5}}}, test::nothing_there());
  loop.step(0, 0);
  loop.bounder().receive(reply(0, 0));
  loop.step(0, 0);
  for (int i = 1; i <= 9; ++i) loop.step(0, 0);
  // 0.1 mm in one tick of ten: Bp range^2/dt; the spring that was stretched goes into it too.
  loop.bounder().receive(reply(0, 1e-4));
  loop.step(1e-4, 0);
  EXPECT_NEAR(loop.energy_J(), 7.5 * 1e-8 / 10e-3 + kSpring_N_per_m / 2 * 1e-8, 1e-12);
}

TEST(SetPositionModulation, IsFreeBeforeTheServerHasSpoken) {
  TwoPortLoop loop(kSetPositionModulation, {}, test::nothing_there());
  for (int i = 0; i < 100; ++i) ASSERT_EQ(loop.step(1e-4 * i, -3), 0);
}

TEST(SetPositionModulation, SendsWhatIsBeyondTheCeilingAndGetsItBackOnce) {
  TwoPortLoop loop(kSetPositionModulation, {.parameters = {{"energy_J_max", 1e-3}}}, test::nothing_there());
  loop.step(0, 0);
  loop.bounder().receive(reply(5e-3, 0));
  loop.step(0, 0);
  EXPECT_NEAR(loop.energy_J(), 1e-3, 1e-15);
  EXPECT_NEAR(loop.law().outgoing()[0], 4e-3, 1e-15);

  const auto server_side = shipped_laws().make_server_side(kSetPositionModulation, 1);
  const Vector x = Vector::Constant(1, 0.5);
  double back_J = 0;
  for (const double sent_J : {10.0, 12.0, 11.0, 12.0}) {
    EXPECT_EQ(server_side->place(
                  {.position = x, .numbers = control::ServerLawNumbers::Constant(1, sent_J), .interval_s = 1e-3}),
              x);
    back_J = server_side->answer(Vector::Zero(1)).numbers[0];
  }
  EXPECT_EQ(back_J, 2) << "of what was sent since it began";
  EXPECT_EQ(server_side->answer(Vector::Zero(1)).numbers[1], 0.5) << "where the environment was asked";
}

// However the device moves under the force, and wherever the environment wants it.
TEST(SetPositionModulation, IsPassiveAgainstAnyMotionAndAnySetPosition) {
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  for (const int dof : {1, 3}) {
    for (const double spring_N_per_m : {100.0, 30e3, 60e3}) {
      SCOPED_TRACE(testing::Message() << dof << " axes, Kp " << spring_N_per_m);
      TwoPortLoop loop(kSetPositionModulation,
                       {.degrees_of_freedom = dof, .parameters = {{"spring_N_per_m", spring_N_per_m}}},
                       test::nothing_there());
      const auto any = [&](double size) {
        return Vector(Vector::NullaryExpr(dof, [&] { return size * normal(random); }));
      };
      Vector x = Vector::Zero(dof);
      Vector force = Vector::Zero(dof);
      double passivity_J = 0;
      double least_J = 0;
      double most_N = 0;
      for (int i = 0; i < 20'000; ++i) {
        // Half of the time the motion that takes most, else any.
        const Vector d = i % 2 == 0 ? Vector(force * 1e-3 / (2 * 30)) : any(1e-4);
        passivity_J += 30 / 1e-3 * d.squaredNorm() - force.dot(d);
        least_J = std::min(least_J, passivity_J);
        x += d;
        if (random() % 3 == 0) loop.bounder().receive(test::saying(0, x + any(1e-3)));
        force = loop.step(x, any(5));
        most_N = std::max(most_N, force.norm());
        ASSERT_GE(loop.energy_J(), -1e-12) << i;
      }
      EXPECT_GE(least_J, -1e-9);
      EXPECT_GT(most_N, 0.1) << "there was force";
    }
  }
}

TEST(SetPositionModulation, RefusesASpringThatTheHoldWouldMakeActive) {
  const auto refusal = [](double spring_N_per_m) {
    return shipped_laws().refusal(kSetPositionModulation, test::ideal_device(1),
                                  {.parameters = {{"spring_N_per_m", spring_N_per_m}}});
  };
  EXPECT_EQ(refusal(60e3), "");
  EXPECT_THAT(refusal(61e3), testing::HasSubstr("spring_N_per_m must be at most 2b/T = 60000 N/m on device 'ideal' (b "
                                                "30 N s/m, T 0.001 s), got 61000"));
}

}  // namespace
}  // namespace forcebound::baselines
