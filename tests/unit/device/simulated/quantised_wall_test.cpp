// The wall that a simulated device shows without a law, beside what others have proved of real ones.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::device {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongTick{20};  // twenty samples of the hand's target
constexpr double kLongTick_s = 20e-3;

/// A hand that lets nothing push it: out from a depth and back in the next tick, over and over.
class Shuttle final : public Operator {
 public:
  Shuttle(double from_m, double stroke_m) : from_m_(from_m), stroke_m_(stroke_m) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "shuttle"; }
  [[nodiscard]] const Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return 1; }
  [[nodiscard]] Target target(double time_s) const noexcept override {
    const double phase = std::fmod(time_s / kLongTick_s + 1e-9, 2.0);
    const double share = phase < 1 ? phase : 2 - phase;
    const bool turns = std::min(share, 1 - share) < 1e-6;
    const double speed_m_per_s = turns ? 0.0 : std::copysign(stroke_m_ / kLongTick_s, 1 - phase);
    return {.position = Vector::Constant(1, from_m_ + share * stroke_m_),
            .velocity = Vector::Constant(1, speed_m_per_s)};
  }
  [[nodiscard]] std::string description() const override { return "shuttle"; }

 private:
  double from_m_;
  double stroke_m_;
  Hand hand_{.stiffness_N_per_m = 1e7, .damping_N_s_per_m = 1e3};
};

struct Limits {
  double damping_N_s_per_m;
  double friction_N;
  double encoder_m;

  /// K <= 2b/T and K <= 2c/q: no path in the wall generates energy, necessary and sufficient [Abbott & Okamura 2005].
  [[nodiscard]] double stiffness_N_per_m() const {
    return std::min(2 * damping_N_s_per_m / kLongTick_s, 2 * friction_N / encoder_m);
  }
};

DeviceDescription description_of(const Limits& limits) {
  DeviceDescription description;
  control::DeviceFacts& facts = description.facts;
  facts.name = "quantised";
  facts.period_s = kLongTick_s;
  facts.damping = Matrix::Constant(1, 1, limits.damping_N_s_per_m);
  facts.friction = Vector::Constant(1, limits.friction_N);
  facts.encoder_step = Vector::Constant(1, limits.encoder_m);
  facts.actuator_step = Vector::Zero(1);
  facts.force_N_max = 1e3;
  facts.releases = false;
  description.inertia = Matrix::Constant(1, 1, 0.05);
  return description;
}

/// P [J] that strokes of this length across the border of two readings leave after a hundred ticks, without a law.
double left_J(const Limits& limits, double stiffness_N_per_m, double stroke_m) {
  const double border_m = 2.5 * limits.encoder_m;
  SimulatedDevice device(description_of(limits),
                         std::make_unique<Shuttle>(border_m - limits.encoder_m / 200, stroke_m));
  control::ForceBounder bounder(device.facts(), control::force_bounding_laws().make("none", device.facts()));
  CommandTimes times(device);
  for (int tick = 0; tick <= 100; ++tick) {
    const Nanoseconds now = tick * kLongTick;
    times.begin_choosing(now);
    const Reading reading = device.read(now);
    const Vector shown = bounder.tick(times.motion_at(reading), -stiffness_N_per_m * reading.position.cwiseMax(0));
    (void)times.command_at(reading, now);
    device.apply(now, shown);
  }
  return device.audit()->energy_J;
}

/// Strokes from a hundredth of a reading's step to a thousand steps.
double least_left_J(const Limits& limits, double stiffness_N_per_m) {
  double least_J = 1;
  for (const double steps : {0.01, 0.02, 0.1, 0.5, 1.0, 1.1, 2.0, 2.1, 5.0, 20.0, 1000.0}) {
    least_J = std::min(least_J, left_J(limits, stiffness_N_per_m, steps * limits.encoder_m));
  }
  return least_J;
}

TEST(QuantisedWall, WithoutALawGeneratesEnergyJustAboveTheBoundOfAbbottAndOkamura) {
  constexpr Limits kCases[] = {
      {.damping_N_s_per_m = 100, .friction_N = 0.2, .encoder_m = 50e-6},   // 2c/q: 8 N/mm
      {.damping_N_s_per_m = 100, .friction_N = 2, .encoder_m = 50e-6},     // 2b/T: 10 N/mm
      {.damping_N_s_per_m = 100, .friction_N = 0.05, .encoder_m = 10e-6},  // both: 10 N/mm
  };
  for (const Limits& limits : kCases) {
    SCOPED_TRACE(limits.stiffness_N_per_m());
    EXPECT_GT(least_left_J(limits, 0.95 * limits.stiffness_N_per_m()), 0);
    EXPECT_LT(least_left_J(limits, 1.05 * limits.stiffness_N_per_m()), 0);
  }
}

}  // namespace
}  // namespace forcebound::device
