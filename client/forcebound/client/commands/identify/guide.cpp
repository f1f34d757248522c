#include "forcebound/client/commands/identify/guide.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/text/numbers.hpp"

namespace forcebound::client::commands::identify {
namespace {

constexpr double kRest_s = 0.3;
constexpr double kRamp_s = 0.03;         // in which a force grows to the largest that a joint may get
constexpr double kUnplugged_s = 1;       // without a usable reading
constexpr double kLatePeriods = 1.5;     // between two commands: a device may let go of the force meanwhile
constexpr double kTripShare = 1.5;       // of the fastest speed: the slide is given up
constexpr double kStopShare = 2;         // and here all of it
constexpr double kLeash = 3;             // how far off a joint may be, in reaches
constexpr double kPushForceShare = 0.9;  // of the force for the joint that moves; the rest holds the others
constexpr double kPushShareOfArm = 0.7;  // as an arm's force for a joint changes on the way
constexpr double kHoldShare = 0.2;       // of what a joint may get, to hold it where it is
constexpr int kTripsMost = 20;
constexpr int kLateMost = 300;

}  // namespace

std::string joint_name(int joint, bool cartesian) {
  return (cartesian ? "axis " : "joint ") + std::to_string(joint + 1);
}

Guide::Guide(const control::DeviceFacts& declared, const GuideSettings& settings)
    : declared_(declared), settings_(settings), random_(settings.seed) {
  if (declared.joints() != declared.degrees_of_freedom()) {
    throw std::invalid_argument("device '" + declared.name + "' has " + std::to_string(declared.joints()) +
                                " joints and a tip of " + std::to_string(declared.degrees_of_freedom()) +
                                " degrees of freedom: no force at the tip pushes a joint on its own, as measuring it "
                                "takes; as many of these as of those are accepted");
  }
  records_.resize(static_cast<std::size_t>(declared.joints()));
  torque_last_ = Vector::Zero(declared.degrees_of_freedom());
}

void Guide::begin(const device::Reading& reading) {
  const int dof = declared_.degrees_of_freedom();
  const Matrix inverse = reading.jacobian.fullPivLu().inverse();
  for (int i = 0; i < dof; ++i) {
    Axis axis;
    const double lever = std::max(reading.jacobian.col(i).norm(), 1e-6);
    axis.home = reading.joint[i];
    axis.reach = settings_.radius_m / lever;
    axis.speed_max = settings_.speed_m_per_s_max / lever;
    const double per_torque = std::max(inverse.row(i).norm(), 1e-9);
    axis.force_max = settings_.force_share * declared_.force_N_max *
                     (declared_.cartesian ? kPushForceShare : kPushShareOfArm) / per_torque;
    axes_.push_back(axis);
  }
  rest_low_ = rest_high_ = last_joint_ = reading.joint;
  since_s_ = time::to_seconds(reading.latched);
}

void Guide::watch(const device::Reading& reading, double latched_s) {
  now_s_ = latched_s;
  const bool moving = state_ == State::push || state_ == State::coast;
  const bool fast = moving && std::abs(axis().watch.speed()) * declared_.period_s > 3 * step() && step() > 0;
  readings_.fast += fast;
  readings_.repeated += fast && reading.joint == last_joint_;
  last_joint_ = reading.joint;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double position = reading.joint[static_cast<Eigen::Index>(i)];
    axes_[i].watch.add(latched_s, position);
    axes_[i].grid.add(position);
  }
}

void Guide::enter(State state) noexcept {
  state_ = state;
  since_s_ = still_since_s_ = now_s_;
}

std::optional<Vector> Guide::tick(const device::Reading& reading, double commanded_s) {
  const int dof = declared_.degrees_of_freedom();
  const Vector nothing = Vector::Zero(dof);
  if (done()) return nothing;
  ++readings_.ticks;
  readings_.stale += reading.status == device::Reading::Status::stale;
  heed_buttons(reading.handle);
  if (!device::is_usable(reading, dof)) {
    unusable_tick(commanded_s);
    return nothing;
  }
  failed_since_s_ = -1;
  const bool late = commanded_s_ > 0 && commanded_s - commanded_s_ > kLatePeriods * declared_.period_s;
  commanded_s_ = commanded_s;
  if (axes_.empty()) begin(reading);
  watch(reading, time::to_seconds(reading.latched));
  if (late) heed_late_tick();
  heed_limits(reading.jacobian);
  if (done()) return nothing;

  Vector torque = held();
  torque_of_state(torque, reading.joint);
  if (done()) return nothing;
  if (state_ == State::coast && now_.silent) {
    torque_last_.setZero();
    return std::nullopt;
  }
  for (int i = 0; i < dof; ++i) torque[i] = risen(i, torque[i]);
  torque_last_ = torque;
  return force_of(torque, reading.jacobian);
}

void Guide::torque_of_state(Vector& torque, const Vector& joint) {
  switch (state_) {
    case State::rest:
      torque.setZero();
      rest_low_ = rest_low_.cwiseMin(joint);
      rest_high_ = rest_high_.cwiseMax(joint);
      rest_tick();
      break;
    case State::grow:
      grow_tick(torque);
      break;
    case State::first_push:
      first_push_tick(torque);
      break;
    case State::place:
      place_tick(torque);
      break;
    case State::push:
      push_tick(torque);
      break;
    case State::coast:
      coast_tick(torque);
      break;
    case State::wait:
      wait_tick(torque);
      break;
    case State::finished:
      break;
  }
}

void Guide::unusable_tick(double commanded_s) {
  ++readings_.failed;
  torque_last_.setZero();
  if (failed_since_s_ < 0) failed_since_s_ = commanded_s;
  if (commanded_s - failed_since_s_ > kUnplugged_s) {
    fail("no usable reading for " + text::rounded(kUnplugged_s) + " s: was the device unplugged?");
  }
  if (sliding()) enter(State::place);
}

/// A button that was pressed before the first reading counts only once it has been released: it may be stuck.
void Guide::heed_buttons(const control::Handle& handle) {
  const std::uint32_t pressed = handle.buttons.value_or(0);
  buttons_ignored_ = buttons_ignored_.value_or(pressed) & pressed;
  const std::uint32_t counting = pressed & ~*buttons_ignored_;
  if (counting == 0) return;
  stopped_by_button_ = true;
  fail("button " + std::to_string(std::countr_zero(counting)) + " of the device was pressed");
}

/// No force is known to have been constant over such a pause.
void Guide::heed_late_tick() {
  ++readings_.late;
  if (state_ != State::push && !(state_ == State::coast && now_.silent)) return;
  enter(State::place);
  if (++readings_.late_slides > kLateMost) {
    fail(std::to_string(kLateMost) + " slides were given up because ticks were late: the machine is too busy");
  }
}

void Guide::heed_limits(const Matrix& jacobian) {
  const int dof = declared_.degrees_of_freedom();
  Vector speeds(dof);
  double rounding = 0;  // of that speed
  for (int i = 0; i < dof; ++i) {
    const Axis& axis = axes_[static_cast<std::size_t>(i)];
    speeds[i] = axis.watch.speed();
    rounding += jacobian.col(i).norm() * axis.watch.rounded_speed(axis.grid.step().value_or(0));
    if (std::abs(axis.watch.position() - axis.home) > kLeash * axis.reach) {
      fail(joint_name(i, declared_.cartesian) + " is " + text::rounded(kLeash) +
           " times as far off as it should get: " + "was it pulled, or do its motors push the wrong way?");
    }
  }
  const double speed = (jacobian * speeds).norm() - rounding;
  const double most = settings_.speed_m_per_s_max;
  if (speed <= kTripShare * most) {
    slow_s_ = now_s_;
    return;
  }
  constexpr double kBrake_s = 0.1;
  const bool braking = state_ == State::place && now_s_ - slow_s_ < kBrake_s;
  if (speed > kStopShare * most || !(sliding() || braking)) {
    fail("the tip was faster than " + text::rounded(kTripShare * most) +
         " m/s: was it pulled, or does a motor push it?");
    return;
  }
  if (!sliding()) return;
  enter(State::place);
  if (++trips_ > kTripsMost) {
    fail("the tip was faster than " + text::rounded(kTripShare * most) + " m/s again and again: was it pulled?");
  }
}

/// Forces grow in a ramp, and end at once.
double Guide::risen(int joint, double wanted) const noexcept {
  const double last = torque_last_[joint];
  const double growth = axes_[static_cast<std::size_t>(joint)].force_max * declared_.period_s / kRamp_s;
  const double from = last * wanted > 0 ? std::abs(last) : 0;
  return std::copysign(std::min(std::abs(wanted), from + growth), wanted);
}

std::optional<Vector> Guide::force_of(const Vector& torque, const Matrix& jacobian) {
  Vector force = torque;
  if (!declared_.cartesian) force = jacobian.transpose().fullPivLu().solve(torque);
  if (!force.allFinite()) force.setZero();
  const double most = settings_.force_share * declared_.force_N_max;
  const double size = force.norm();
  if (size > most) {
    force *= most / size;
    // A push that was cut is no constant force.
    if (state_ == State::push) {
      if (++trips_ > kTripsMost) fail("a push and what holds the other joints exceed the allowed force");
      enter(State::place);
    }
  }
  force_N_most_ = std::max(force_N_most_, std::min(size, most));
  return force;
}

/// All joints held where they are to be, the one that moves included.
Vector Guide::held() const noexcept {
  Vector torque(declared_.degrees_of_freedom());
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    const JointGuess& guess = records_[i].guess;
    const bool unknown = !(guess.mass > 0);
    torque[static_cast<Eigen::Index>(i)] =
        unknown ? 0 : force_towards(axis.home, axis.watch, guess, 0.05 * axis.reach, kHoldShare * axis.force_max);
  }
  return torque;
}

void Guide::rest_tick() {
  if (now_s_ - since_s_ < kRest_s) return;
  const Vector apart = rest_high_ - rest_low_;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double moved = apart[static_cast<Eigen::Index>(i)];
    const double step = axes_[i].grid.step().value_or(0);
    if (step > 0) readings_.rest_steps = std::max(readings_.rest_steps, moved / step);
    constexpr double kMovedShare = 0.03;
    constexpr double kMovedSteps = 3.5;
    if (moved > kMovedShare * axes_[i].reach && moved > kMovedSteps * step) {
      fail(joint_name(static_cast<int>(i), declared_.cartesian) +
           " moved while no force was commanded: let go of the handle, and let it rest");
    }
  }
  joint_ = -1;
  next_joint();
}

ReadingFacts Guide::readings() const {
  ReadingFacts facts = readings_;
  for (const Axis& axis : axes_) facts.encoder_step.push_back(axis.grid.step().value_or(0));
  return facts;
}

}  // namespace forcebound::client::commands::identify
