#include "forcebound/client/commands/identify/joint_control.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::client::commands::identify {

void JointWatch::add(double time_s, double position) noexcept {
  readings_[next_] = {time_s, position};
  next_ = (next_ + 1) % kReadings;
  count_ = std::min(count_ + 1, kReadings);
}

double JointWatch::speed() const noexcept {
  constexpr std::size_t kLeast = 3;
  if (count_ < kLeast) return 0;
  double time = 0;
  double position = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    time += at(i).time_s;
    position += at(i).position;
  }
  const auto n = static_cast<double>(count_);
  double above = 0;
  double below = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const double t = at(i).time_s - time / n;
    above += t * (at(i).position - position / n);
    below += t * t;
  }
  return below > 0 ? above / below : 0;
}

double JointWatch::rounded_speed(double step) const noexcept {
  if (count_ < 2) return 0;
  const double time_s = at(0).time_s - at(count_ - 1).time_s;
  return time_s > 0 ? step / time_s : 0;
}

double force_towards(double target, const JointWatch& joint, const JointGuess& guess, double tolerance,
                     double force_max) noexcept {
  constexpr double kSpringRate = 20;  // 1/s: slow beside delays of a few ms
  constexpr double kFrictionShare = 0.8;
  const double off = target - joint.position();
  const double friction = kFrictionShare * guess.friction * std::clamp(off / tolerance, -1.0, 1.0);
  const double damping = std::max(2 * guess.mass * kSpringRate - guess.damping, 0.0);
  const double force = guess.mass * kSpringRate * kSpringRate * off - damping * joint.speed() + friction;
  return std::clamp(force, -force_max, force_max);
}

}  // namespace forcebound::client::commands::identify
