#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/support/ideal_device.hpp"
#include "tests/support/pressed_wall.hpp"
#include "tests/support/published_law_checks.hpp"

namespace forcebound::baselines {
namespace {

using test::kPeriod_s;
using test::LawLoop;

control::DeviceFacts device(int degrees_of_freedom) {
  control::DeviceFacts facts;
  facts.name = "bench";
  facts.damping = 30 * Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
  facts.force_N_max = 30;
  return facts;
}

std::string refusal_on(const control::DeviceFacts& facts, const control::LawParameters& chosen = {}) {
  return shipped_laws().refusal("vc", facts, {.parameters = chosen});
}

TEST(VirtualCoupling, RefusesACouplingThatTheDampingDoesNotCoverWithTheNumbers) {
  EXPECT_EQ(refusal_on(device(1), {{"coupling_N_per_m", 54e3}, {"coupling_damping_N_s_per_m", 3}}),
            "law 'vc': device 'bench' has a damping of 30 N s/m; a coupling of 54000 N/m and 3 N s/m at a period of "
            "0.001 s needs more than Kc T/2 + |Bc| = 30 N s/m");
  EXPECT_EQ(refusal_on(device(1), {{"coupling_N_per_m", 53.99e3}, {"coupling_damping_N_s_per_m", 3}}), "");
}

TEST(VirtualCoupling, UsesTheDirectionWithTheLeastDamping) {
  control::DeviceFacts facts = device(3);
  facts.damping(1, 1) = 10;
  EXPECT_EQ(refusal_on(facts), "");
  EXPECT_DOUBLE_EQ(shipped_laws().parameters("vc", facts).at("coupling_N_per_m"), 0.9 * 2 * 10 / kPeriod_s);
  EXPECT_THAT(refusal_on(facts, {{"coupling_N_per_m", 20e3}}), testing::HasSubstr("has a damping of 10 N s/m"));
}

TEST(VirtualCoupling, RefusesADeviceWhoseDampingChangesWithTheConfiguration) {
  control::DeviceFacts facts = device(3);
  facts.cartesian = false;
  EXPECT_THAT(refusal_on(facts), testing::HasSubstr("device 'bench' is an arm"));
}

TEST(VirtualCoupling, RefusesInvalidCouplings) {
  EXPECT_THAT(refusal_on(device(1), {{"coupling_N_per_m", 0}}), testing::HasSubstr("coupling_N_per_m must be"));
  EXPECT_THAT(refusal_on(device(1), {{"tool_mass_kg", -1}}), testing::HasSubstr("tool_mass_kg must be"));
}

/// One axis, and the tool's own state once more.
class OneAxis {
 public:
  explicit OneAxis(const control::LawParameters& parameters, double force_N_max = 1e9)
      : loop_("vc", Matrix::Constant(1, 1, 30), {.force_N_max = force_N_max, .parameters = parameters}) {}

  double tick(double position_m, double request_N) { return loop_.tick(position_m, request_N); }
  [[nodiscard]] double tool_m() const { return loop_.proxy_position(Vector::Constant(1, 0.0))[0]; }
  [[nodiscard]] double energy_J() const { return loop_.energy_J(); }

 private:
  LawLoop loop_;
};

TEST(VirtualCoupling, IsASpringAndADamperToATool) {
  constexpr double kc = 40e3;
  constexpr double bc = 5;
  constexpr double m = 0.02;
  OneAxis axis(
      {{"coupling_N_per_m", kc}, {"coupling_damping_N_s_per_m", bc}, {"tool_mass_kg", m}, {"contact_periods", 0}});
  axis.tick(0, 0);
  double tool_m = axis.tool_m();
  double device_m = 0;
  double speed_m_per_s = 0;
  for (int i = 1; i <= 300; ++i) {
    const double next_m = 1e-3 * std::sin(0.05 * i);
    const double request_N = -2 - 1.5 * std::cos(0.3 * i);
    const double force_N = axis.tick(next_m, request_N);
    const double next_tool_m = axis.tool_m();
    const double next_speed = (next_tool_m - tool_m) / kPeriod_s;
    const double coupling_N = kc * (next_m - next_tool_m) + bc * ((next_m - device_m) / kPeriod_s - next_speed);
    ASSERT_NEAR(force_N, -coupling_N, 1e-9) << i;
    ASSERT_NEAR(m * (next_speed - speed_m_per_s) / kPeriod_s, request_N + coupling_N, 1e-7) << i;
    tool_m = next_tool_m;
    device_m = next_m;
    speed_m_per_s = next_speed;
  }
}

TEST(VirtualCoupling, HasAToolThatGainsNoMoreThanDeviceAndEnvironmentPutIn) {
  for (const double force_N_max : {1e9, 10.0}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", largest force " << force_N_max);
      std::mt19937_64 random(seed);
      std::normal_distribution<double> normal;
      OneAxis axis({}, force_N_max);
      axis.tick(0, 0);
      double device_m = 0;
      double stored_J = 0;
      double request_N = 0;
      for (int i = 0; i < 2000; ++i) {
        const double tool_m = axis.tool_m();
        const double next_m = device_m + 1e-4 * normal(random);
        request_N = i % 50 < 10 ? 0.0 : std::clamp(request_N + 3 * normal(random), -10.0, 10.0);
        const double force_N = axis.tick(next_m, request_N);
        const double put_in_J = -force_N * (next_m - device_m) + request_N * (axis.tool_m() - tool_m);
        ASSERT_LE(axis.energy_J() - stored_J, put_in_J + 1e-12) << "tick " << i;
        ASSERT_LE(std::abs(force_N), force_N_max * (1 + 1e-12));
        stored_J = axis.energy_J();
        device_m = next_m;
      }
    }
  }
}

TEST(VirtualCoupling, LosesJustWhatImplicitEulerAndItsDamperTake) {
  constexpr double kc = 40e3;
  constexpr double bc = 5;
  constexpr double m = 0.02;
  OneAxis axis(
      {{"coupling_N_per_m", kc}, {"coupling_damping_N_s_per_m", bc}, {"tool_mass_kg", m}, {"contact_periods", 0}});
  axis.tick(0, 0);
  double device_m = 0;
  double speed_m_per_s = 0;
  double stored_J = 0;
  for (int i = 1; i <= 200; ++i) {
    const double stretch_m = device_m - axis.tool_m();
    const double tool_m = axis.tool_m();
    const double next_m = 5e-4 * std::sin(0.1 * i);
    const double force_N = axis.tick(next_m, -5);
    const double tool_step_m = axis.tool_m() - tool_m;
    const double stretched_m = next_m - axis.tool_m() - stretch_m;
    const double faster = tool_step_m / kPeriod_s - speed_m_per_s;
    const double lost_J = (kc / 2 + bc / kPeriod_s) * stretched_m * stretched_m + m / 2 * faster * faster;
    const double put_in_J = -force_N * (next_m - device_m) - 5 * tool_step_m;
    ASSERT_NEAR(axis.energy_J() - stored_J, put_in_J - lost_J, 1e-12) << i;
    stored_J = axis.energy_J();
    speed_m_per_s += faster;
    device_m = next_m;
  }
}

TEST(VirtualCoupling, IsNotThereInFreeSpace) {
  LawLoop loop("vc", 30 * Matrix::Identity(3, 3));
  for (int i = 0; i < 100; ++i) {
    const Vector at = Vector::Constant(3, 1e-3 * i * i);
    EXPECT_TRUE(loop.tick(at, Vector::Zero(3)).isZero(0)) << i;
    EXPECT_EQ(loop.proxy_position(Vector::Zero(3)), at);
  }
}

TEST(VirtualCoupling, LetsGoSomeTicksAfterTheEnvironmentDoes) {
  OneAxis axis({});
  for (int i = 0; i < 50; ++i) axis.tick(1e-5 * i, -5);
  EXPECT_NEAR(axis.tick(5e-4, -5), -5, 0.5);
  int ticks = 0;
  while (axis.tick(5e-4, 0) != 0) ASSERT_LT(++ticks, 10);
  EXPECT_EQ(axis.tool_m(), 5e-4);
  EXPECT_EQ(axis.energy_J(), 0.0);
}

TEST(VirtualCoupling, ShowsWallAndCouplingInARowHoweverLateTheAnswerUpToTwoTicks) {
  for (const double stiffness_N_per_m : {1e3, 50e3, 150e3, 300e3}) {
    for (const int late_ticks : {0, 1, 2}) {
      for (const double hand_N_per_m : {200.0, 1000.0}) {
        SCOPED_TRACE(testing::Message() << stiffness_N_per_m << " N/m, " << late_ticks << " ticks late, hand "
                                        << hand_N_per_m << " N/m");
        const auto result = test::press({.law = "vc",
                                         .stiffness_N_per_m = stiffness_N_per_m,
                                         .late_ticks = late_ticks,
                                         .hand_N_per_m = hand_N_per_m});
        const double shown = 1 / (1 / stiffness_N_per_m + 1 / 54e3);
        EXPECT_NEAR(result.shown_N_per_m, shown, 1e-3 * shown);
        EXPECT_LT(result.ripple_N, 0.01);
      }
    }
  }
}

TEST(VirtualCoupling, ReturnsNothingBeyondTheDampingFromAWallOf150) {
  for (const int late_ticks : {0, 1, 2}) {
    const auto result = test::press({.law = "vc", .late_ticks = late_ticks, .retreats = true});
    EXPECT_GE(result.least_P_J, -1e-6) << late_ticks;
  }
}

TEST(VirtualCoupling, ShowsAsMuchThroughAnEncoder) {
  for (const int late_ticks : {0, 1, 2}) {
    const auto result = test::press({.law = "vc", .late_ticks = late_ticks, .encoder_m = 15e-6});
    const double shown = 1 / (1 / 150e3 + 1 / 54e3);
    EXPECT_NEAR(result.shown_N_per_m, shown, 0.02 * shown) << late_ticks;
    EXPECT_LT(result.ripple_N, 1.2) << "a step of the coupling is 0.81 N";
  }
}

TEST(VirtualCoupling, NeedsItsContactDampedWhereTheAnswerIsLate) {
  const auto result = test::press({.law = "vc", .parameters = {{"contact_periods", 0}}, .late_ticks = 1});
  EXPECT_GT(result.ripple_N, 5) << "150 N/mm are more than Kc + Bc/T = 55.5 N/mm";
}

TEST(VirtualCoupling, BeginsAgainWhereTheDeviceComesBack) {
  LawLoop loop("vc", Matrix::Constant(1, 1, 30));
  loop.tick(0.0, 0.0);
  EXPECT_LT(loop.tick(1e-3, -10), 0.0);
  EXPECT_EQ(loop.tick(std::nan(""), -10), 0.0);
  EXPECT_EQ(loop.proxy_position(Vector::Constant(1, 7.0))[0], 7.0)
      << "there is no tool while the device's position is unknown";
  EXPECT_EQ(loop.tick(0.2, 0.0), 0.0);
  EXPECT_EQ(loop.proxy_position(Vector::Zero(1))[0], 0.2);
}

TEST(VirtualCoupling, WorksWithAClockThatStandsStill) {
  LawLoop late("vc", Matrix::Constant(1, 1, 30));
  LawLoop punctual("vc", Matrix::Constant(1, 1, 30));
  for (const double interval_s : {1e-3, 0.0, -1.0, 1e300, std::nan(""), 5e-3, 1e-3}) {
    late.set_interval(interval_s);
    EXPECT_EQ(late.tick(1e-4, -1.0), punctual.tick(1e-4, -1.0)) << interval_s;
  }
}

TEST(VirtualCoupling, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests("vc"); }

}  // namespace
}  // namespace forcebound::baselines
