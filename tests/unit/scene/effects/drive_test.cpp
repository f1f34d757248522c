#include "forcebound/scene/effects/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "tests/support/effect_probe.hpp"

namespace forcebound::scene {
namespace {

constexpr double kPi = std::numbers::pi;

struct Wave {
  std::string waveform = "sine";
  double frequency_Hz = 2;
  double frequency_end_Hz = 0;
  double phase_rad = 0;
  double start_s = 0;
  double duration_s = std::numeric_limits<double>::infinity();
  double duty = 0.5;
};

/// A = 3 N along y.
std::unique_ptr<Effect> drive(const Wave& wave) {
  return drive_effect().make({{"waveform", wave.waveform},
                              {"direction", Point(0, 1, 0)},
                              {"amplitude_N", 3.0},
                              {"frequency_Hz", wave.frequency_Hz},
                              {"frequency_end_Hz", wave.frequency_end_Hz},
                              {"phase_rad", wave.phase_rad},
                              {"start_s", wave.start_s},
                              {"duration_s", wave.duration_s},
                              {"duty", wave.duty}});
}

double force_N_at(const Effect& effect, double time_s) {
  const Point force = test::force_N(effect, {.position_m = {1, 2, 3}, .time_s = time_s});
  EXPECT_EQ(force.x(), 0);
  EXPECT_EQ(force.z(), 0);
  return force.y();
}

double force_N_at(const Wave& wave, double time_s) { return force_N_at(*drive(wave), time_s); }

TEST(Drive, SineFollowsTheSine) {
  const auto effect = drive({});
  for (int i = 0; i < 100; ++i) {
    const double time_s = 0.0137 * i;
    EXPECT_NEAR(force_N_at(*effect, time_s), 3 * std::sin(2 * kPi * 2 * time_s), 1e-12);
  }
}

TEST(Drive, PhaseShiftsIt) {
  EXPECT_NEAR(force_N_at({.phase_rad = kPi / 2}, 0), 3, 1e-12);
  EXPECT_NEAR(force_N_at({.phase_rad = -kPi / 2}, 0), -3, 1e-12);
}

TEST(Drive, SquareIsOnForItsDuty) {
  EXPECT_EQ(force_N_at({.waveform = "square"}, 0.24), 3);
  EXPECT_EQ(force_N_at({.waveform = "square"}, 0.26), -3);
  EXPECT_EQ(force_N_at({.waveform = "square", .duty = 0.1}, 0.06), -3);
}

TEST(Drive, PulseIsNothingBetween) {
  EXPECT_EQ(force_N_at({.waveform = "pulse", .duty = 0.1}, 0.04), 3);
  EXPECT_EQ(force_N_at({.waveform = "pulse", .duty = 0.1}, 0.06), 0);
  EXPECT_EQ(force_N_at({.waveform = "pulse", .duty = 0.1}, 0.54), 3);
}

TEST(Drive, TriangleRisesAndFallsEvenly) {
  const auto effect = drive({.waveform = "triangle"});
  EXPECT_NEAR(force_N_at(*effect, 0), 0, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.0625), 1.5, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.125), 3, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.25), 0, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.375), -3, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.4375), -1.5, 1e-12);
}

TEST(Drive, SawtoothFallsInTheMiddleOfItsPeriod) {
  const auto effect = drive({.waveform = "sawtooth"});
  EXPECT_NEAR(force_N_at(*effect, 0), 0, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.125), 1.5, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.25 - 1e-9), 3, 1e-6);
  EXPECT_NEAR(force_N_at(*effect, 0.25), -3, 1e-12);
  EXPECT_NEAR(force_N_at(*effect, 0.375), -1.5, 1e-12);
}

TEST(Drive, ChirpGoesFromOneFrequencyToTheOther) {
  const auto effect = drive({.waveform = "chirp", .frequency_Hz = 1, .frequency_end_Hz = 21, .duration_s = 10});
  for (const double time_s : {0.0, 0.31, 2.5, 7.77, 9.99}) {
    EXPECT_NEAR(force_N_at(*effect, time_s), 3 * std::sin(2 * kPi * (time_s + time_s * time_s)), 1e-9) << time_s;
  }
}

TEST(Drive, ActsFromItsStartForItsDuration) {
  const Wave wave{.waveform = "square", .start_s = 1, .duration_s = 0.25};
  EXPECT_EQ(force_N_at(wave, 0.99), 0);
  EXPECT_EQ(force_N_at(wave, 1), 3);
  EXPECT_EQ(force_N_at(wave, 1.24), 3);
  EXPECT_EQ(force_N_at(wave, 1.25), 0);
}

TEST(Drive, NeverExceedsItsAmplitudeHoweverLate) {
  for (const auto* const waveform : {"sine", "square", "triangle", "sawtooth", "pulse"}) {
    const auto effect = drive({.waveform = waveform, .frequency_Hz = 1e6, .phase_rad = -1e6});
    for (const double time_s : {0.0, 1e-9, 1.0, 1e6, 9.2e9}) {
      EXPECT_LE(std::abs(force_N_at(*effect, time_s)), 3) << waveform << " " << time_s;
    }
  }
}

TEST(Drive, RefusesWhatItsWaveformDoesNotHave) {
  EXPECT_THROW(drive({.duty = 0.1}), std::invalid_argument);
  EXPECT_THROW(drive({.frequency_end_Hz = 5}), std::invalid_argument);
  EXPECT_THROW(drive({.waveform = "chirp", .duration_s = 1}), std::invalid_argument);
  EXPECT_THROW(drive({.waveform = "chirp", .frequency_end_Hz = 5}), std::invalid_argument);
}

TEST(Drive, LooksAtTimeAlone) {
  EXPECT_TRUE(drive({})->facts().inputs.time);
  EXPECT_FALSE(drive({})->facts().inputs.velocity);
}

}  // namespace
}  // namespace forcebound::scene
