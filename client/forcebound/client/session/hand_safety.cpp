#include "forcebound/client/session/hand_safety.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "forcebound/control/rotation.hpp"
#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::client {
namespace {

constexpr double kSpeedMean_s = 5e-3;
constexpr double kTickMost_s = 0.005;
constexpr double kGone_s = 0.02;       // without a usable reading: more than a reading or two that were late
constexpr double kSlowAgain = 0.5;     // of the speed limit
constexpr double kCoolAgain = 0.9;     // of the mean square
constexpr double kCapMoves_per_s = 1;  // of the limit
constexpr double kCapNone = 10;        // of the limit: there is no cap any more

/// Share of a mean that the newest `elapsed_s` have.
double share_of_newest(double elapsed_s, double mean_s) noexcept { return 1 - std::exp(-elapsed_s / mean_s); }

}  // namespace

Vector HandSafety::limited(const Vector& wanted_N, const Tick& tick) noexcept {
  const double elapsed_s = std::max(0.0, tick.elapsed_s);
  share_ = 0;
  bool heated = update_load(force_load_, tick.applied_N.norm(), limits_.rms_force_N_max, tick.elapsed_s);
  heated |= update_load(torque_load_, tick.applied_N_m.norm(), limits_.rms_torque_N_m_max, tick.elapsed_s);
  if (heated) begin(Trip::heat);
  const double since_reading_s = missing_s_ + elapsed_s;
  // As long without a tick as without a reading: the device has let go of the force meanwhile.
  if (since_reading_s > kGone_s) {
    ramp_ = 0;
    forget_speeds();
  }
  if (!tick.position.allFinite()) {
    missing_s_ = since_reading_s;
    return Vector::Zero(wanted_N.rows());
  }
  missing_s_ = 0;
  update_speeds(tick, since_reading_s);
  update_button(tick);
  if (tick.frozen && !frozen_) begin(Trip::frozen);
  frozen_ = tick.frozen;
  if (speed_.too_fast || turn_.too_fast || let_go_ || frozen_) {
    ramp_ = 0;
    return Vector::Zero(wanted_N.rows());
  }
  // By ticks: a pause between two readings is no time in which the force grew.
  ramp_ = limits_.ramp_s > 0 ? std::min(1.0, ramp_ + std::min(elapsed_s, kTickMost_s) / limits_.ramp_s) : 1;
  share_ = ramp_ * fade(tick.position) * tick.believed;
  Vector asked_N = share_ * wanted_N;
  const double length_N = asked_N.norm();
  // Deep in a stiff object a small share of what is wanted is all that the device has.
  const double most_N = ramp_ < 1 ? std::min(force_load_.cap, ramp_ * force_N_max_) : force_load_.cap;
  if (length_N > most_N) asked_N *= most_N / length_N;
  return asked_N;
}

Eigen::Vector3d HandSafety::limited_torque(const Eigen::Vector3d& wanted_N_m) const noexcept {
  const double most_N_m = ramp_ < 1 ? std::min(torque_load_.cap, ramp_ * torque_N_m_max_) : torque_load_.cap;
  return local_model::no_longer_than<Eigen::Vector3d>(share_ * wanted_N_m, most_N_m);
}

void HandSafety::update_speeds(const Tick& tick, double elapsed_s) noexcept {
  const bool moves = speed_.most_per_s > 0 && last_position_;
  if (moves && update_speed(speed_, (tick.position - *last_position_).norm(), elapsed_s)) begin(Trip::speed);
  last_position_ = tick.position;
  std::optional<Eigen::Quaterniond> orientation;
  if (tick.handle.orientation) orientation = control::quaternion_of(*tick.handle.orientation);
  const bool turns = turn_.most_per_s > 0 && last_orientation_ && orientation;
  if (turns && update_speed(turn_, last_orientation_->angularDistance(*orientation), elapsed_s)) begin(Trip::turn);
  last_orientation_ = orientation;
}

bool HandSafety::update_speed(Speed& speed, double way, double elapsed_s) noexcept {
  if (!(elapsed_s > 0)) return false;
  speed.mean_per_s += share_of_newest(elapsed_s, kSpeedMean_s) * (way / elapsed_s - speed.mean_per_s);
  if (speed.mean_per_s > speed.most_per_s) return !std::exchange(speed.too_fast, true);
  if (speed.mean_per_s < kSlowAgain * speed.most_per_s) speed.too_fast = false;
  return false;
}

/// A hand that was too fast must show that it is slow, from its limit down.
void HandSafety::forget_speeds() noexcept {
  last_position_.reset();
  last_orientation_.reset();
  for (Speed* const speed : {&speed_, &turn_}) speed->mean_per_s = speed->too_fast ? speed->most_per_s : 0;
}

void HandSafety::update_button(const Tick& tick) noexcept {
  if (!limits_.dead_man_button) return;
  const bool up = !tick.handle.pressed(*limits_.dead_man_button);
  if (up && !let_go_) begin(Trip::dead_man);
  let_go_ = up;
}

bool HandSafety::update_load(Load& load, double applied, double most, double elapsed_s) const noexcept {
  if (!(most > 0) || !(elapsed_s > 0) || !std::isfinite(applied)) return false;
  bool heated = false;
  load.mean_square += share_of_newest(elapsed_s, limits_.rms_s) * (applied * applied - load.mean_square);
  if (load.mean_square > most * most) {
    if (!std::exchange(load.hot, true)) {
      load.cap = std::max(std::min(load.cap, applied), most);
      heated = true;
    }
  } else if (load.mean_square < kCoolAgain * most * most) {
    load.hot = false;
  }
  const double moves = kCapMoves_per_s * most * elapsed_s;
  load.cap = load.hot ? std::max(most, load.cap - moves) : load.cap + moves;
  if (load.cap > kCapNone * most) load.cap = std::numeric_limits<double>::infinity();
  return heated;
}

double HandSafety::fade(const Vector& position) noexcept {
  if (!(limits_.workspace_radius_m > 0)) return 1;
  const double beyond_m = position.norm() - limits_.workspace_radius_m;
  if (beyond_m <= 0) {
    outside_ = false;
    return 1;
  }
  if (!std::exchange(outside_, true)) begin(Trip::workspace);
  return std::max(0.0, 1 - beyond_m / limits_.workspace_fade_m);
}

void HandSafety::begin(Trip which) noexcept {
  ++trips_[which];
  newest_ = which;
}

std::optional<HandSafety::Trip> HandSafety::take_trip() noexcept { return std::exchange(newest_, std::nullopt); }

}  // namespace forcebound::client
