#include "tests/support/pressed_wall.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "tests/support/law_loop.hpp"

namespace forcebound::test {
namespace {

constexpr double kMass_kg = 0.1;
constexpr double kHandDamping_N_s_per_m = 2;
constexpr double kLargestForce_N = 30;
constexpr double kSpeed_m_per_s = 0.05;
constexpr double kStart_m = -2e-3;
constexpr double kTarget_m = 10e-3;
constexpr int kTicks = 3000;
constexpr int kRetreat = 2000;
constexpr int kMeasured = 300;

struct Target {
  double at_m = 0;
  double speed_m_per_s = 0;
};

Target target(double time_s, bool retreats) {
  const double retreat_s = kRetreat * kPeriod_s;
  if (retreats && time_s > retreat_s) {
    const double at_m = kTarget_m - kSpeed_m_per_s * (time_s - retreat_s);
    return at_m > kStart_m ? Target{at_m, -kSpeed_m_per_s} : Target{kStart_m, 0};
  }
  const double at_m = kStart_m + kSpeed_m_per_s * time_s;
  return at_m < kTarget_m ? Target{at_m, kSpeed_m_per_s} : Target{kTarget_m, 0};
}

/// Device and hand, in steps of a hundredth of a tick, which is 30 times below the device's time constant.
class Motion {
 public:
  explicit Motion(const PressedWall& setting) : setting_(setting) {}

  void live(double force_N) {
    constexpr int kSteps = 100;
    constexpr double kStep_s = kPeriod_s / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const Target hand = target(time_s_, setting_.retreats);
      const double pull_N =
          setting_.hand_N_per_m * (hand.at_m - at_m_) + kHandDamping_N_s_per_m * (hand.speed_m_per_s - speed_m_per_s_);
      const double before = speed_m_per_s_;
      speed_m_per_s_ += kStep_s / kMass_kg * (force_N + pull_N - kDamping_N_s_per_m * speed_m_per_s_);
      const double step_m = kStep_s * (before + speed_m_per_s_) / 2;
      at_m_ += step_m;
      time_s_ += kStep_s;
      audit_J_ += kDamping_N_s_per_m * step_m * step_m / kStep_s - force_N * step_m;
      least_audit_J_ = std::min(least_audit_J_, audit_J_);
      (force_N * step_m < 0 ? stored_J_ : returned_J_) += std::abs(force_N * step_m);
    }
  }

  [[nodiscard]] double at_m() const { return at_m_; }
  [[nodiscard]] double least_audit_J() const { return least_audit_J_; }
  [[nodiscard]] double stored_J() const { return stored_J_; }
  [[nodiscard]] double returned_J() const { return returned_J_; }

 private:
  const PressedWall& setting_;
  double time_s_ = 0;
  double at_m_ = kStart_m;
  double speed_m_per_s_ = 0;
  double audit_J_ = 0;
  double least_audit_J_ = 0;
  double stored_J_ = 0;
  double returned_J_ = 0;
};

}  // namespace

PressedWallResult press(const PressedWall& setting) {
  LawLoop loop(setting.law, control::Matrix::Constant(1, 1, kDamping_N_s_per_m),
               {.period_s = kPeriod_s, .force_N_max = kLargestForce_N, .parameters = setting.parameters});
  Motion motion(setting);
  std::deque<double> asked(static_cast<std::size_t>(setting.late_ticks), kStart_m);
  PressedWallResult result;
  double depth_m = 0;
  double force_sum_N = 0;
  double least_N = kLargestForce_N;
  double most_N = -kLargestForce_N;
  for (int tick = 0; tick < kTicks; ++tick) {
    const double step_m = setting.encoder_m;
    const double read_m = step_m > 0 ? step_m * std::round(motion.at_m() / step_m) : motion.at_m();
    asked.push_back(loop.proxy_position(control::Vector::Constant(1, read_m))[0]);
    const double request_N = -setting.stiffness_N_per_m * std::max(0.0, asked.front());
    asked.pop_front();
    const double force_N = loop.tick(read_m, request_N);
    const int end = setting.retreats ? kRetreat : kTicks;
    if (tick >= end - kMeasured && tick < end) {
      depth_m += motion.at_m();
      force_sum_N += force_N;
      least_N = std::min(least_N, force_N);
      most_N = std::max(most_N, force_N);
    }
    motion.live(force_N);
  }
  result.shown_N_per_m = -force_sum_N / depth_m;
  result.ripple_N = most_N - least_N;
  result.least_P_J = motion.least_audit_J();
  result.stored_J = motion.stored_J();
  result.returned_J = motion.returned_J();
  return result;
}

void expect_calms_a_wall_too_stiff(std::string_view law) {
  const PressedWallResult without = press({.law = "none", .stiffness_N_per_m = 8e4, .hand_N_per_m = 2000});
  const PressedWallResult with = press({.law = law, .stiffness_N_per_m = 8e4, .hand_N_per_m = 2000});
  EXPECT_LT(with.ripple_N, 0.5 * without.ripple_N);
  EXPECT_GT(with.least_P_J, 0.01 * without.least_P_J);
}

}  // namespace forcebound::test
