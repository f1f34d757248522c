#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "forcebound/scene/effects/adhesion.hpp"
#include "forcebound/scene/effects/magnet.hpp"
#include "forcebound/scene/effects/stick_slip.hpp"
#include "forcebound/scene/effects/texture.hpp"
#include "forcebound/scene/effects/vibration.hpp"
#include "tests/support/effect_probe.hpp"

namespace forcebound::scene {
namespace {

using std::numbers::pi;

/// At x on a table, `above_m` over it (below: negative).
Probe over_table(double x_m, double above_m) {
  return {.position_m = Point(x_m, 0, above_m), .normal = Point::UnitZ(), .penetration_m = -above_m};
}

TEST(StickSlip, PullsBackToItsAnchorUntilItJumps) {
  const auto effect = stick_slip_effect().make({{"stiffness_N_per_m", 100.0}, {"slip_N", 0.5}});
  test::EffectProbe felt(*effect);
  EXPECT_EQ(felt(over_table(0.01, -1e-3)).force_N.norm(), 0) << "the anchor is where it first touches";
  EXPECT_NEAR(felt(over_table(0.0149, -1e-3)).force_N.x(), -0.49, 1e-12);
  EXPECT_EQ(felt(over_table(0.0152, -1e-3)).force_N.norm(), 0) << "it has slipped";
  EXPECT_NEAR(felt(over_table(0.0142, -1e-3)).force_N.x(), 0.1, 1e-12) << "from the new anchor";
}

TEST(StickSlip, NeverReturnsMoreThanTheHandPut) {
  const auto effect = stick_slip_effect().make({{"stiffness_N_per_m", 100.0}, {"slip_N", 0.5}});
  test::EffectProbe felt(*effect);
  double put_J = 0;
  Point last_m(0, 0, -1e-3);
  (void)felt(over_table(0, -1e-3));
  for (int i = 1; i < 20000; ++i) {
    const double x_m = 0.03 * std::sin(0.01 * i) + 0.002 * std::sin(0.37 * i);
    const Probe probe = over_table(x_m, -1e-3);
    put_J -= felt(probe).force_N.dot(probe.position_m - last_m);
    last_m = probe.position_m;
    ASSERT_GE(put_J, -1e-12) << i;
  }
  EXPECT_GT(put_J, 0.01);
}

TEST(Vibration, FollowsItsWaveformAlongTheNormal) {
  const auto vibration = [](const char* waveform) {
    return vibration_effect().make({{"amplitude_N", 2.0},
                                    {"frequency_Hz", 50.0},
                                    {"phase_turns", 0.0},
                                    {"along", std::string("normal")},
                                    {"axis", Point(1, 0, 0)},
                                    {"waveform", std::string(waveform)}});
  };
  Probe probe = over_table(0, -1e-3);
  probe.time_s = 0.0025;  // an eighth of a period
  EXPECT_TRUE(test::force_N(*vibration("sine"), probe).isApprox(Point(0, 0, std::sqrt(2)), 1e-12));
  EXPECT_TRUE(test::force_N(*vibration("square"), probe).isApprox(Point(0, 0, 2), 1e-12));
  EXPECT_TRUE(test::force_N(*vibration("triangle"), probe).isApprox(Point(0, 0, 1), 1e-12));
  EXPECT_TRUE(test::force_N(*vibration("sawtooth"), probe).isApprox(Point(0, 0, 0.5), 1e-12));
  probe.time_s = 0.0175;  // seven eighths
  EXPECT_TRUE(test::force_N(*vibration("sine"), probe).isApprox(Point(0, 0, -std::sqrt(2)), 1e-12));
  EXPECT_TRUE(test::force_N(*vibration("square"), probe).isApprox(Point(0, 0, -2), 1e-12));
  EXPECT_TRUE(test::force_N(*vibration("triangle"), probe).isApprox(Point(0, 0, -1), 1e-12));
  EXPECT_TRUE(test::force_N(*vibration("sawtooth"), probe).isApprox(Point(0, 0, -0.5), 1e-12));
}

TEST(Vibration, GoesAlongAnyAxis) {
  const auto effect = vibration_effect().make({{"amplitude_N", 1.0},
                                               {"frequency_Hz", 1.0},
                                               {"phase_turns", 0.25},
                                               {"along", std::string("axis")},
                                               {"axis", Point(0.6, 0.8, 0)},
                                               {"waveform", std::string("sine")}});
  EXPECT_TRUE(test::force_N(*effect, over_table(0, -1e-3)).isApprox(Point(0.6, 0.8, 0), 1e-12));
}

std::unique_ptr<Effect> magnet() { return magnet_effect().make({{"force_N_max", 2.0}, {"range_m", 0.03}}); }

TEST(Magnet, PullsMostAtAThirdOfItsRangeAndNotAtItsEnds) {
  EXPECT_TRUE(test::force_N(*magnet(), over_table(0, 0.01)).isApprox(Point(0, 0, -2), 1e-12));
  EXPECT_LT(test::force_N(*magnet(), over_table(0, 0.009)).norm(), 2);
  EXPECT_LT(test::force_N(*magnet(), over_table(0, 0.011)).norm(), 2);
  EXPECT_LT(test::force_N(*magnet(), over_table(0, 1e-9)).norm(), 1e-6);
  EXPECT_LT(test::force_N(*magnet(), over_table(0, 0.03 - 1e-6)).norm(), 1e-6);
  EXPECT_EQ(test::force_N(*magnet(), over_table(0, 0.04)).norm(), 0);
  EXPECT_EQ(test::force_N(*magnet(), over_table(0, -0.001)).norm(), 0) << "within, the surface counts";
  EXPECT_EQ(magnet()->facts().reach_m, 0.03);
}

TEST(Magnet, PullsAsMuchInAsOut) {
  // The work down from the end of the range: F range 27/4 (1/2 - 2/3 + 1/4) = 9/16 F range.
  double work_J = 0;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) {
    const double above_m = 0.03 * (i + 0.5) / kSteps;
    work_J -= test::force_N(*magnet(), over_table(0, above_m)).z() * 0.03 / kSteps;
  }
  EXPECT_NEAR(work_J, 9.0 / 16 * 2 * 0.03, 1e-9);
}

std::unique_ptr<Effect> adhesion(double shear_N = 0.3) {
  return adhesion_effect().make(
      {{"stiffness_N_per_m", 200.0}, {"tear_N", 1.0}, {"shear_stiffness_N_per_m", 400.0}, {"shear_N", shear_N}});
}

TEST(Adhesion, HoldsOnlyWhatHasTouched) {
  const auto effect = adhesion();
  test::EffectProbe felt(*effect);
  EXPECT_EQ(felt(over_table(0, 0.002)).force_N.norm(), 0);
  EXPECT_EQ(felt(over_table(0, -0.001)).force_N.norm(), 0);
  EXPECT_NEAR(felt(over_table(0, 0.002)).force_N.z(), -0.4, 1e-12);
  EXPECT_NEAR(felt(over_table(0, 0.0049)).force_N.z(), -0.98, 1e-12);
  EXPECT_NEAR(felt(over_table(0, 0.001)).force_N.z(), -0.2, 1e-12) << "comes back";
  EXPECT_EQ(felt(over_table(0, 0.0051)).force_N.norm(), 0) << "torn";
  EXPECT_EQ(felt(over_table(0, 0.001)).force_N.norm(), 0) << "and does not hold again";
  (void)felt(over_table(0, -0.001));
  EXPECT_NEAR(felt(over_table(0, 0.002)).force_N.z(), -0.4, 1e-12) << "until touched";
  EXPECT_EQ(adhesion()->facts().reach_m, 0.005);
}

TEST(Adhesion, HoldsSidewaysUpToItsShear) {
  const auto effect = adhesion();
  test::EffectProbe felt(*effect);
  (void)felt(over_table(0, -0.001));
  EXPECT_NEAR(felt(over_table(0.0005, -0.001)).force_N.x(), -0.2, 1e-12);
  EXPECT_NEAR(felt(over_table(0.005, -0.001)).force_N.x(), -0.3, 1e-12);
}

TEST(Adhesion, NeverReturnsMoreThanTheHandPut) {
  const auto effect = adhesion();
  test::EffectProbe felt(*effect);
  double put_J = 0;
  Point last_m(0, 0, -0.001);
  (void)felt(over_table(0, -0.001));
  for (int i = 1; i < 50000; ++i) {
    const Probe probe = over_table(0.002 * std::sin(0.013 * i), 0.0035 * std::sin(0.0071 * i));
    // A spring's backward difference: its own storage makes up for what the step's end counts too much.
    const Point force_N = felt(probe).force_N;
    put_J -= force_N.dot(probe.position_m - last_m);
    last_m = probe.position_m;
    ASSERT_GE(put_J, -1e-9) << i;
  }
}

TEST(Texture, SendsTheWaveInTheTangentPlane) {
  const auto effect = texture_effect().make({{"amplitude_N", 0.3},
                                             {"wavelength_m", 0.002},
                                             {"direction", Point(0.6, 0, 0.8)},
                                             {"pattern", std::string("grid")}});
  test::EffectProbe felt(*effect);
  const Reaction reaction = felt(over_table(0, -0.001));
  EXPECT_EQ(reaction.force_N.norm(), 0);
  EXPECT_EQ(reaction.texture.amplitude_N, 0.3);
  EXPECT_EQ(reaction.texture.waves, 2);
  EXPECT_TRUE(reaction.texture.waves_rad_per_m[0].isApprox(Point(1000 * pi, 0, 0), 1e-12));
  EXPECT_TRUE(reaction.texture.waves_rad_per_m[1].isApprox(Point(0, 1000 * pi, 0), 1e-12));
}

TEST(Texture, AlongTheNormalIsNone) {
  const auto effect = texture_effect().make({{"amplitude_N", 0.3},
                                             {"wavelength_m", 0.002},
                                             {"direction", Point(0, 0, 1)},
                                             {"pattern", std::string("ridges")}});
  EXPECT_EQ(test::EffectProbe(*effect)(over_table(0, -0.001)).texture.amplitude_N, 0);
}

}  // namespace
}  // namespace forcebound::scene
