#include "forcebound/control/least_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/tools/reference/reference_exact.hpp"

namespace forcebound::control {
namespace {

using test::ForcePiece;
using test::JointFacts;
using test::ReferenceReading;

LeastEnergy::Tube tube(double reading, double step) { return {reading - step / 2, reading + step / 2}; }

/// Readings of a device that mostly follows its force, is jerked about, or rests; one to three forces between two.
std::vector<ReferenceReading> random_readings(std::uint64_t seed, int count, double step_m) {
  std::mt19937_64 random(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<ReferenceReading> readings{{.position_m = 0, .since = {}}};
  double position_m = 0;
  double velocity_m_per_s = 0;
  for (int n = 1; n < count; ++n) {
    if (number(0, 1) < 0.3) velocity_m_per_s = number(0, 1) < 0.4 ? 0 : number(-0.05, 0.05);
    ReferenceReading reading;
    const int pieces = std::uniform_int_distribution<int>(1, 3)(random);
    for (int i = 0; i < pieces; ++i) reading.since.push_back({number(-2, 2), number(1e-4, 1e-3)});
    position_m += velocity_m_per_s * 1e-3 + number(-0.2, 0.2) * step_m;
    reading.position_m = step_m > 0 ? step_m * std::round(position_m / step_m) : position_m;
    readings.push_back(reading);
  }
  return readings;
}

double energy_of(const JointFacts& joint, double step_m, const std::vector<ReferenceReading>& readings,
                 int* knots = nullptr) {
  LeastEnergy v(joint.damping_N_s_per_m, joint.friction_N);
  v.restart(tube(readings.front().position_m, step_m));
  double energy_J = 0;
  for (std::size_t n = 1; n < readings.size(); ++n) {
    for (const ForcePiece& piece : readings[n].since) energy_J += v.hold(piece.force_N, 0, piece.duration_s);
    const auto gain_J = v.read(tube(readings[n].position_m, step_m));
    EXPECT_TRUE(gain_J.has_value()) << "reading " << n;
    energy_J += gain_J.value_or(0);
    if (knots != nullptr) *knots = std::max(*knots, v.knots());
  }
  return energy_J;
}

TEST(LeastEnergy, OfAnIdealEncoderIsTheCostOfEachStep) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    const JointFacts joint{.damping_N_s_per_m = 30, .friction_N = seed % 2 == 0 ? 0.0 : 0.3};
    const auto readings = random_readings(seed, 100, 0);
    long double expected_J = 0;
    for (std::size_t n = 1; n < readings.size(); ++n) {
      expected_J += least_cost_J(joint, readings[n].since,
                                 static_cast<long double>(readings[n].position_m) - readings[n - 1].position_m);
    }
    EXPECT_NEAR(energy_of(joint, 0, readings), static_cast<double>(expected_J), 1e-12);
  }
}

TEST(LeastEnergy, WithoutFrictionIsTheMinimumOverAllPathsThroughTheTubes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const JointFacts joint{.damping_N_s_per_m = 5, .friction_N = 0};
    for (const double step_m : {15e-6, 55e-6}) {
      const auto readings = random_readings(seed, 40, step_m);
      const auto expected_J = static_cast<double>(least_energy_without_friction_J(joint, step_m, readings));
      EXPECT_NEAR(energy_of(joint, step_m, readings), expected_J, 1e-10 * (1 + std::abs(expected_J)));
    }
  }
}

TEST(LeastEnergy, WithFrictionIsCloselyBelowTheMinimumOverPathsOnAGrid) {
  constexpr double kStep_m = 55e-6;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    const JointFacts joint{.damping_N_s_per_m = 5, .friction_N = 0.2};
    const auto readings = random_readings(seed, 12, kStep_m);
    const auto grid_J = static_cast<double>(least_energy_on_grid_J(joint, kStep_m, readings, 61));
    const double energy_J = energy_of(joint, kStep_m, readings);
    EXPECT_LE(energy_J, grid_J + 1e-12);
    // The grid's paths are off by up to one place of the grid on every reading.
    EXPECT_GE(energy_J, grid_J - 12 * (joint.friction_N * kStep_m / 60 + 5 / 1e-3 * std::pow(kStep_m / 60, 2)));
  }
}

TEST(LeastEnergy, KeepsNoMoreKnotsThanItSays) {
  // Creeping from count to count with friction, under forces that change all the time: two kinks for each.
  constexpr double kStep_m = 55e-6;
  LeastEnergy v(30, 0.5);
  v.restart(tube(0, kStep_m));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> force_N(-0.25, 0.25);
  int most = 0;
  double reading_m = 0;
  for (int i = 0; i < 10'000; ++i) {
    if (i % 30 == 0) reading_m += random() % 2 == 0 ? kStep_m : -kStep_m;
    v.hold(force_N(random), 0, 1e-3);
    ASSERT_TRUE(v.read(tube(reading_m, kStep_m)).has_value());
    most = std::max(most, v.knots());
  }
  EXPECT_LE(most, LeastEnergy::kKnotsMax);
  EXPECT_EQ(most, LeastEnergy::kKnotsMax) << "no knot was ever merged";
}

TEST(LeastEnergy, RemembersAMergeOfWhichTheNextReadingLeavesNoTrace) {
  LeastEnergy v(30, 0.5);
  v.restart(tube(0, 1));
  for (int i = 0; i < 40; ++i) v.hold(i * 0.01, 0, 1e-3);
  ASSERT_TRUE(v.read(tube(0, 1e-9)).has_value());
  EXPECT_LT(v.knots(), 10);
  EXPECT_TRUE(v.merged());
}

TEST(LeastEnergy, IsNeverAboveWhatAPathThatFitsTheReadingsCosts) {
  constexpr double kStep_m = 55e-6;
  const JointFacts joint{.damping_N_s_per_m = 3, .friction_N = 0.5};
  int most = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto number = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    LeastEnergy v(joint.damping_N_s_per_m, joint.friction_N);
    v.restart(tube(0, kStep_m));
    double position_m = 0;
    double velocity_m_per_s = 0;
    double force_N = 0;
    double energy_J = 0;
    double true_J = 0;
    for (int i = 0; i < 5'000; ++i) {
      if (number(0, 1) < 0.02) velocity_m_per_s = number(-1, 1) * number(0, 0.002);
      if (number(0, 1) < 0.05) force_N = number(-1, 1);
      force_N += number(-1e-3, 1e-3);
      const double duration_s = number(2e-4, 2e-3);
      const double way_m = velocity_m_per_s * duration_s;
      true_J +=
          way_m * way_m * joint.damping_N_s_per_m / duration_s + joint.friction_N * std::abs(way_m) - force_N * way_m;
      position_m += way_m;
      energy_J += v.hold(force_N, 0, duration_s);
      energy_J += v.read(tube(kStep_m * std::round(position_m / kStep_m), kStep_m * (1 + 1e-9))).value();
      most = std::max(most, v.knots());
      ASSERT_LE(energy_J, true_J + 1e-12) << "reading " << i;
    }
  }
  EXPECT_EQ(most, LeastEnergy::kKnotsMax) << "no knot was ever merged";
}

TEST(LeastEnergy, CreditsNothingForAFlickeringEncoder) {
  constexpr double kStep_m = 15e-6;
  LeastEnergy v(30, 0);
  v.restart(tube(0, kStep_m));
  double energy_J = 0;
  for (int i = 0; i < 100'000; ++i) {
    energy_J += v.hold(0, 0, 1e-3);
    energy_J += v.read(tube(i % 2 == 0 ? kStep_m : 0, kStep_m)).value();
  }
  EXPECT_NEAR(energy_J, 0, 1e-20);
}

TEST(LeastEnergy, CountsTheReserveOfAForceAtOnce) {
  LeastEnergy v(30, 0.5);
  v.restart(tube(0, 15e-6));
  EXPECT_DOUBLE_EQ(v.hold(2.5, 0, 1e-3), -2.0 * 2.0 * 1e-3 / 120);
  EXPECT_EQ(v.hold(0.5, 0, 1e-3), 0) << "friction alone holds it";
  EXPECT_EQ(v.hold(-0.4, 0, 1e-3), 0);
}

TEST(LeastEnergy, RefusesAReadingThatNoFiniteMotionExplains) {
  LeastEnergy v(30, 0);
  v.restart({0, 1e-6});
  EXPECT_FALSE(v.read({1e-3, 2e-3}).has_value()) << "no time has passed";
  EXPECT_EQ(v.read({0, 1e-7}), 0.0) << "and V is as it was";
  v.hold(1, 0, 1e-3);
  EXPECT_FALSE(v.read({1e308, 1e308}).has_value());
  EXPECT_TRUE(v.read({1e-3, 2e-3}).has_value());
}

TEST(LeastEnergy, OfATorqueThatMayBeOffIsWhatGoingToAndFroMakesOfIt) {
  // 30 N s/m, friction 0.2 N, the torque anywhere within -0.5 to 0.5 N for a millisecond.
  LeastEnergy v(30, 0.2);
  v.restart({0, 0});
  const double taken_J = 0.3 * 0.3 * 1e-3 / 120;
  EXPECT_DOUBLE_EQ(v.hold(0, 0.5, 1e-3), -taken_J);
  // Up to 0.3 N/(2b) for the whole time nothing is to be gained from knowing where it went.
  EXPECT_NEAR(v.read({4e-6, 4e-6}).value(), 0, 1e-18);
  LeastEnergy far(30, 0.2);
  far.restart({0, 0});
  (void)far.hold(0, 0.5, 1e-3);
  const double d = 2e-4;
  EXPECT_NEAR(far.read({d, d}).value(), 30 * d * d / 1e-3 - 0.3 * d + taken_J, 1e-15);
}

}  // namespace
}  // namespace forcebound::control
