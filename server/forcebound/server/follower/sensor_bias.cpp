#include "forcebound/server/follower/sensor_bias.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcebound::server {
namespace {

constexpr double kSmooth_s = 0.05;
constexpr int kSamplesMost = 1000;  // drift that is slower than a touch in so many stays one
constexpr double kDeviations = 3;
// Less than a touch, so that a force that grows is one before it counts as free.
constexpr double kSameShare = 0.4;

}  // namespace

SensorBias::SensorBias(const std::optional<ForceSensorFacts>& facts) noexcept
    : has_sensor_(facts.has_value()),
      touch_N_(kTouch_N + kDeviations * (facts ? facts->noise_N_sd : 0)),
      touch_N_m_(kTouch_N_m + kDeviations * (facts ? facts->noise_N_m_sd : 0)) {}

void SensorBias::command(Nanoseconds now) noexcept {
  commanded_ = now;
  count_ = 0;
}

void SensorBias::update(const Sample& sample) noexcept {
  if (commanded_ && !has_sensor_) return give(Answer::no_sensor);
  if (commanded_ && sample.now - *commanded_ > kCommandMost) return give(Answer::no_samples);
  if (!sample.sensed || sample.sensed->sampled == last_) return;
  smooth(*sample.sensed);
  if (sample.waits) return learn(wrench_of(*sample.sensed), sample.now, true);
  if (sample.holds) {
    anchor_ = {.tool_m = sample.tool_m, .wrench = smoothed_};
  } else {
    look_for_free_motion(sample.tool_m);
  }
  const bool touches = sample.holds || differs(smoothed_, untouched_, 1);
  if (touches) count_ = 0;
  if (touches && commanded_) {
    give(sample.holds ? Answer::holds : Answer::touches, (smoothed_ - untouched_).head<3>().norm());
  }
  if (touches) return;
  if (sample.stands || commanded_) return learn(wrench_of(*sample.sensed), sample.now, false);
  count_ = 0;
}

void SensorBias::smooth(const SensedForce& sensed) noexcept {
  const Vector6 wrench = wrench_of(sensed);
  const double passed_s = last_ ? time::to_seconds(sensed.sampled - *last_) : 0;
  smoothed_ =
      last_ ? Vector6(smoothed_ + (1 - std::exp(-std::max(0.0, passed_s) / kSmooth_s)) * (wrench - smoothed_)) : wrench;
  last_ = sensed.sampled;
}

/// The way is along the force, not across it: what slides on a wall moves at the same force too.
void SensorBias::look_for_free_motion(const Eigen::Vector3d& tool_m) noexcept {
  const Eigen::Vector3d way = tool_m - anchor_.tool_m;
  const Eigen::Vector3d force = (smoothed_ - untouched_).head<3>();
  const double along_m = force.norm() > 0 ? std::abs(way.dot(force.normalized())) : 0;
  const double across_m = std::sqrt(std::max(0.0, way.squaredNorm() - along_m * along_m));
  const bool free = along_m >= kWay_m;
  const bool same = !differs(smoothed_, anchor_.wrench, kSameShare);
  if (same && free) untouched_ = smoothed_;
  if (!same || free || across_m > kWay_m / 2) anchor_ = {.tool_m = tool_m, .wrench = smoothed_};
}

/// @param at_once from the first sample on, not after kSamplesLeast
void SensorBias::learn(const Vector6& wrench, Nanoseconds now, bool at_once) noexcept {
  count_ = std::min(count_ + 1, kSamplesMost);
  if (count_ == 1) mean_ = wrench;
  mean_ += (wrench - mean_) / count_;
  if (!at_once && count_ < kSamplesLeast) return;
  const double changed_N = (mean_ - bias_).head<3>().norm();
  bias_ = mean_;
  untouched_ = mean_;
  status_.learned = now;
  if (commanded_ && count_ >= kSamplesLeast) give(Answer::learned, changed_N);
}

bool SensorBias::differs(const Vector6& wrench, const Vector6& other, double share) const noexcept {
  const Vector6 off = wrench - other;
  return off.head<3>().norm() > share * touch_N_ || off.tail<3>().norm() > share * touch_N_m_;
}

void SensorBias::give(Answer answer, double off_N) noexcept {
  commanded_.reset();
  ++status_.answers;
  status_.answer = answer;
  status_.off_N = off_N;
}

Vector6 SensorBias::wrench_of(const SensedForce& sensed) noexcept {
  Vector6 wrench;
  wrench << sensed.force_N, sensed.torque_N_m;
  return wrench;
}

std::string_view words_of(SensorBias::Answer answer) noexcept {
  using enum SensorBias::Answer;
  switch (answer) {
    case none:
      return "was not asked for";
    case learned:
      return "is learned again";
    case no_sensor:
      return "is not learned: the robot has no force sensor";
    case no_samples:
      return "is not learned: the sensor told too little for 5 s";
    case touches:
      return "is not learned: the tool touches something, or the sensor has drifted while it moved; if it touches "
             "nothing, lead it along that force by 2 cm, and ask again";
    case holds:
      return "is not learned: the gripper holds something";
  }
  return {};
}

}  // namespace forcebound::server
