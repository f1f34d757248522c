#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>

#include "tests/support/two_port_loop.hpp"

namespace forcebound::baselines {
namespace {

using test::TwoPortLoop;

constexpr const char* kWaveVariables = "wave";
constexpr double kImpedance_N_s_per_m = 15;
constexpr Eigen::Index kEnergy = 4;  // of what the device says; its integral follows

const double kRoot = std::sqrt(2 * kImpedance_N_s_per_m);

TEST(WaveVariables, FeelsTheWaveImpedanceWhereNothingComesBack) {
  TwoPortLoop loop(kWaveVariables, {}, test::nothing_there());
  loop.step(0, 0);
  for (int i = 1; i < 20; ++i) EXPECT_NEAR(loop.step(1e-4 * i, -7), -kImpedance_N_s_per_m * 0.1, 1e-12);
  // u = (b_w v + F)/sqrt(2 b_w) with F = b_w v: all that is taken goes out, u^2/2 = F v.
  const control::ServerLawNumbers before = loop.law().outgoing();
  loop.step(20e-4, 0);
  const control::ServerLawNumbers after = loop.law().outgoing();
  EXPECT_NEAR(after[kEnergy + 1] - before[kEnergy + 1], kRoot * 0.1 * 1e-3, 1e-15);
  EXPECT_NEAR(after[kEnergy] - before[kEnergy], kImpedance_N_s_per_m * 0.01 * 1e-3, 1e-15);
}

TEST(WaveVariables, CodesAndDecodesForceAndVelocityWithoutLoss) {
  TwoPortLoop loop(kWaveVariables, {}, test::nothing_there());
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double x_m = 0;
  double force_N = loop.step(x_m, 0);
  control::ServerLawNumbers before = loop.law().outgoing();
  control::ServerLawNumbers back = test::saying(0, Vector::Zero(1));
  for (int i = 0; i < 1000; ++i) {
    const double v_m_per_s = 0.05 * normal(random);
    const double w = 0.5 * normal(random);
    back[0] += 10;
    back[1] += w * 1e-3;
    loop.bounder().receive(back);
    x_m += v_m_per_s * 1e-3;
    const double held_N = force_N;
    force_N = loop.step(x_m, 0);
    EXPECT_NEAR(-force_N, kImpedance_N_s_per_m * v_m_per_s - kRoot * w, 1e-9);
    const control::ServerLawNumbers after = loop.law().outgoing();
    if (i > 0) {
      const double u = (after[kEnergy + 1] - before[kEnergy + 1]) / 1e-3;
      EXPECT_NEAR(u, (kImpedance_N_s_per_m * v_m_per_s - held_N) / kRoot, 1e-7);
    }
    before = after;
  }
}

TEST(WaveVariables, TakesEachSampleOnceAndWhatWasLostWithTheNext) {
  TwoPortLoop loop(kWaveVariables, {}, test::nothing_there());
  loop.step(0, 0);
  const auto wave = [](int samples) { return test::saying(0.5e-3 * samples, Vector::Constant(1, 1e-3 * samples)); };
  loop.bounder().receive(wave(1));  // w = 1 for a tick
  EXPECT_NEAR(loop.step(0, 0), kRoot, 1e-12);
  loop.bounder().receive(wave(1));
  EXPECT_NEAR(loop.step(0, 0), 0, 1e-12) << "a copy adds no wave";
  loop.bounder().receive(wave(3));
  EXPECT_NEAR(loop.step(0, 0), std::sqrt(2.0) * kRoot, 1e-12) << "two samples, with the energy of two and no more";
  loop.step(0, 0);
  EXPECT_LE(loop.energy_J(), 1e-15);
}

// The other end returns all that comes, late, lost, doubled and in any order.
TEST(WaveVariables, MakeNoEnergyOfAnEchoHoweverLateLostOrDoubled) {
  for (const bool constant : {true, false}) {
    for (const std::size_t delay_ticks : {0U, 1U, 50U}) {
      SCOPED_TRACE(testing::Message() << delay_ticks << " ticks, " << (constant ? "constant" : "with loss"));
      std::mt19937_64 random(23);
      std::normal_distribution<double> normal;
      TwoPortLoop loop(kWaveVariables, {}, test::nothing_there());
      std::deque<control::ServerLawNumbers> way;
      double x_m = 0;
      double force_N = 0;
      double passivity_J = 0;
      double excess_J = 0;
      double most_N = 0;
      for (int i = 0; i < 20'000; ++i) {
        const double d = i % 2 == 0 ? force_N * 1e-3 / (2 * 30) : 1e-5 * normal(random);
        passivity_J += 30e3 * d * d - force_N * d;
        excess_J = std::max(excess_J, std::min(0.0, loop.energy_J()) - passivity_J);
        x_m += d;
        force_N = loop.step(x_m, 0);
        most_N = std::max(most_N, std::abs(force_N));
        const control::ServerLawNumbers sums = loop.law().outgoing();
        if (sums.rows() > kEnergy) way.emplace_back(sums.tail(2));
        if (way.size() <= delay_ticks) continue;
        const bool lost = !constant && random() % 5 == 0;
        const std::size_t at = constant ? 0 : random() % way.size();
        if (!lost) loop.bounder().receive(way[at]);
        if (constant || random() % 3 != 0) way.pop_front();
      }
      EXPECT_LE(excess_J, 1e-6);
      EXPECT_GT(most_N, 0.1);
    }
  }
}

TEST(WaveVariables, TheToolAtTheServerGoesWhereTheDeviceGoesAndDoesNotDrift) {
  for (const std::size_t delay_ticks : {0U, 20U}) {
    TwoPortLoop loop(kWaveVariables, {.delay_ticks = delay_ticks}, test::nothing_there());
    for (int i = 0; i <= 4000; ++i) loop.tick(0.02 * std::sin(2e-3 * M_PI * i));
    for (int i = 0; i < 1000; ++i) loop.tick(0);
    EXPECT_NEAR(loop.place()[0], 0, 1e-3) << delay_ticks;
  }
}

TEST(WaveVariables, HoldTheForceOfAWallWhileTheDeviceStands) {
  for (const std::size_t delay_ticks : {0U, 20U}) {
    TwoPortLoop loop(kWaveVariables, {.delay_ticks = delay_ticks}, test::wall_of(2000));
    for (int i = 0; i <= 500; ++i) loop.tick(-1e-3 + 1e-5 * i);
    double force_N = 0;
    for (int i = 0; i < 4000; ++i) force_N = loop.tick(4e-3);
    // The wall and the spring between wave and tool, one after the other: 4 mm of 2000 N/m beside 30000 N/m.
    EXPECT_LT(force_N, -2) << delay_ticks;
    EXPECT_NEAR(-2000 * loop.place()[0], force_N, 0.05 * std::abs(force_N)) << "device and environment feel the same";
  }
}

}  // namespace
}  // namespace forcebound::baselines
