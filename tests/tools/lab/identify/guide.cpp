#include "tests/tools/lab/identify/guide.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/identify/first_guess.hpp"

namespace forcebound::lab::identify {
namespace {

constexpr double kRest_s = 0.3;
constexpr double kGrow_s = 1.5;          // until the force has grown to the most
constexpr double kGivenUp_s = 0.3;       // at the most without motion
constexpr double kUnplugged_s = 1;       // without a usable reading
constexpr double kSilence_s = 0.15;      // no device holds a force for longer without saying so
constexpr double kPushForceShare = 0.9;  // of the force for the joint that moves; the rest holds the others
constexpr double kPushShareOfArm = 0.7;  // as an arm's force for a joint changes on the way
constexpr double kHoldShare = 0.2;       // of what a joint may get, to hold it where it is
constexpr double kPushShare = 0.45;      // of the way, for the push
constexpr double kDampedShare = 0.7;     // of the speed sought, on average while pushed
constexpr int kTripsMost = 20;
constexpr int kUnmovedMost = 4;
constexpr int kExtraMost = 128;
constexpr int kExtraAtOnce = 8;
constexpr double kDelayErrorGoal_s = 6.5e-6;

std::string joint_name(int joint, bool cartesian) {
  return (cartesian ? "axis " : "joint ") + std::to_string(joint + 1);
}

}  // namespace

Guide::Guide(const control::DeviceFacts& declared, const GuideSettings& settings)
    : declared_(declared), settings_(settings), random_(settings.seed) {
  if (declared.joints() != declared.degrees_of_freedom()) {
    throw std::invalid_argument("device '" + declared.name + "' has " + std::to_string(declared.joints()) +
                                " joints and a tip of " + std::to_string(declared.degrees_of_freedom()) +
                                " degrees of freedom: no force at the tip pushes a joint on its own, as measuring it "
                                "takes; as many of these as of those are accepted");
  }
  records_.resize(static_cast<std::size_t>(declared.joints()));
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
  if (!device::is_usable(reading, dof)) {
    ++readings_.failed;
    if (failed_since_s_ < 0) failed_since_s_ = commanded_s;
    if (commanded_s - failed_since_s_ > kUnplugged_s) {
      fail("no usable reading for " + text::rounded(kUnplugged_s) + " s: was the device unplugged?");
    }
    if (state_ == State::push || state_ == State::coast) enter(State::place);
    return nothing;
  }
  failed_since_s_ = -1;
  commanded_s_ = commanded_s;
  if (axes_.empty()) begin(reading);
  watch(reading, time::to_seconds(reading.latched));

  Vector speeds(dof);
  for (int i = 0; i < dof; ++i) speeds[i] = axes_[static_cast<std::size_t>(i)].watch.speed();
  constexpr double kTripAt = 1.5;
  if ((reading.jacobian * speeds).norm() > kTripAt * settings_.speed_m_per_s_max && state_ != State::place) {
    const bool sliding = state_ == State::push || state_ == State::coast;
    if (!sliding || ++trips_ > kTripsMost) {
      fail("the tip was faster than " + text::rounded(kTripAt * settings_.speed_m_per_s_max) +
           " m/s again and again: was it pulled?");
    }
    enter(State::place);
  }

  Vector torque = held();
  switch (state_) {
    case State::rest:
      torque.setZero();
      rest_low_ = rest_low_.cwiseMin(reading.joint);
      rest_high_ = rest_high_.cwiseMax(reading.joint);
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
    case State::finished:
      break;
  }
  if (done()) return nothing;
  if (state_ == State::coast && now_.silent) return std::nullopt;
  return force_of(torque, reading.jacobian);
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

void Guide::next_joint() {
  ++joint_;
  plan_.clear();
  planned_ = 0;
  unmoved_ = 0;
  joint_done_ = refit_due_ = false;
  if (joint_ == declared_.degrees_of_freedom()) {
    plan_more();
    return;
  }
  slide_ = {.joint = joint_, .direction = 1};
  start_ = axis().watch.position();
  axis().home = start_;
  enter(State::grow);
}

void Guide::give_up_joint(const std::string& why) {
  record().refused = why;
  if (extra_joint_ >= 0) {
    enter(State::finished);
  } else {
    next_joint();
  }
}

void Guide::grow_tick(Vector& torque) {
  const double force = axis().force_max * std::min((now_s_ - since_s_) / kGrow_s, 1.0);
  torque[joint_] = force;
  constexpr double kMovedShare = 0.02;
  constexpr double kMovedSteps = 6;
  if (std::abs(progress()) > std::max(kMovedShare * axis().reach, kMovedSteps * step())) {
    record().break_away = force;
    constexpr double kMore = 0.15;
    push_force_ = std::min(force + kMore * axis().force_max, axis().force_max);
    torque[joint_] = 0;
    enter(State::first_push);
    slide_.samples.clear();
    return;
  }
  if (now_s_ - since_s_ > kGrow_s + kGivenUp_s) {
    give_up_joint("it did not move under " + text::rounded(force) + (declared_.cartesian ? " N" : " N m") +
                  ", the largest force that is allowed here");
    torque = held();
  }
}

void Guide::first_push_tick(Vector& torque) {
  constexpr double kPause_s = 0.06;
  torque[joint_] = 0;
  if (now_s_ - since_s_ < kPause_s) return;
  torque[joint_] = push_force_;
  if (slide_.samples.empty()) {
    release_speed_ = axis().watch.speed();
    start_ = axis().watch.position();
  }
  slide_.samples.push_back({now_s_, progress(), commanded_s_, push_force_});
  constexpr double kFarShare = 0.2;
  constexpr double kFastShare = 0.6;
  constexpr std::size_t kSamplesLeast = 8;
  const bool far = progress() > kFarShare * axis().reach || speed() > kFastShare * axis().speed_max;
  if (slide_.samples.size() < kSamplesLeast || (!far && now_s_ - since_s_ < 1)) return;
  record().guess = first_guess(slide_, release_speed_, record().break_away);
  plan_ = {{0.5}, {0.5}, {0.5}, {0.5}};
  for (int i = 0; i < 4; ++i) {
    plan_.insert(plan_.end(), {{1}, {1}, {0.25, false, true}, {0.25, false, true}});
    plan_.insert(plan_.end(), {{0.5, false, true}, {1, true}, {1, true}, {0.25, false, true}});
  }
  next_slide();
  torque[joint_] = 0;
}

/// The speed up to which the allowed force brings the joint on its share of the way.
double Guide::fastest() const noexcept {
  const JointGuess& guess = record().guess;
  const double per_square = guess.mass / (2 * kPushShare * 2 * axis().reach);
  const double per_speed = kDampedShare * guess.damping;
  constexpr double kSlowShare = 0.1;
  constexpr double kReserve = 0.95;
  const double slow = kSlowShare * axis().speed_max;
  const double force = axis().force_max - guess.friction;
  if (force <= 0) return slow;
  const double speed = (std::sqrt(per_speed * per_speed + 4 * per_square * force) - per_speed) / (2 * per_square);
  return std::clamp(kReserve * speed, slow, axis().speed_max);
}

void Guide::next_slide() {
  if (planned_ >= plan_.size()) {
    joint_done_ = true;
    start_ = axis().home;
    enter(State::place);
    return;
  }
  now_ = plan_[planned_++];
  const double direction = -slide_.direction;
  slide_ = {.joint = joint_, .direction = direction};
  slide_.end = now_.silent ? Slide::End::silence : Slide::End::zero;
  std::uniform_real_distribution<double> off(-0.08, 0.08);
  const bool late = now_.short_way && random_() % 2 == 0;
  start_ = axis().home - direction * axis().reach * ((late ? 0 : 1) + off(random_));
  travel_ = (now_.short_way ? 1 : 2) * axis().reach;
  enter(State::place);
}

void Guide::place_tick(Vector& torque) {
  const JointGuess& guess = record().guess;
  torque[joint_] = force_towards(start_, axis().watch, guess, 0.05 * axis().reach, axis().force_max);
  constexpr double kStillShare = 0.02;
  constexpr double kStill_s = 0.03;
  constexpr double kLeast_s = 0.05;
  constexpr double kNear = 0.15;
  constexpr double kPatience_s = 1;
  constexpr double kMost_s = 3;
  constexpr double kOneStepIn_s = 0.011;
  const double still = std::max(kStillShare * fastest(), step() / kOneStepIn_s);
  if (std::abs(axis().watch.speed()) > still) still_since_s_ = now_s_;
  const double elapsed_s = now_s_ - since_s_;
  const bool rests = now_s_ - still_since_s_ > kStill_s && elapsed_s > kLeast_s;
  const bool near = std::abs(axis().watch.position() - start_) < kNear * axis().reach;
  if (!(rests && (near || elapsed_s > kPatience_s)) && elapsed_s < kMost_s) return;
  // The fits take longer than a tick: only where the joint rests.
  if (std::exchange(refit_due_, false)) {
    refit();
    still_since_s_ = now_s_;
  } else if (std::exchange(joint_done_, false)) {
    if (extra_joint_ >= 0) {
      plan_more();
    } else {
      next_joint();
    }
    torque = held();
  } else {
    begin_push();
    push_tick(torque);
  }
}

void Guide::begin_push() {
  const double end = start_ + slide_.direction * travel_;
  start_ = axis().watch.position();
  travel_ = std::max(slide_.direction * (end - start_), 0.5 * axis().reach);
  slide_.begin = start_ - axis().home;
  slide_.samples.clear();
  slide_.released = 0;
  target_speed_ = now_.speed_share * fastest();
  const JointGuess& guess = record().guess;
  const double force = guess.friction + kDampedShare * guess.damping * target_speed_ +
                       guess.mass * target_speed_ * target_speed_ / (2 * kPushShare * travel_);
  push_force_ = std::clamp(force, 0.02 * axis().force_max, axis().force_max);
  moved_since_s_ = now_s_;
  moved_to_ = 0;
  enter(State::push);
}

void Guide::push_tick(Vector& torque) {
  const double way = progress();
  constexpr double kMovedShare = 0.01;
  if (way > moved_to_ + std::max(kMovedShare * travel_, 2 * step())) {
    moved_to_ = way;
    moved_since_s_ = now_s_;
  }
  constexpr double kStuck_s = 0.08;
  if (now_s_ - moved_since_s_ > kStuck_s) {
    if (push_force_ >= axis().force_max) {
      if (++unmoved_ >= kUnmovedMost) {
        give_up_joint("it no longer moved under " + text::rounded(push_force_) + (declared_.cartesian ? " N" : " N m") +
                      "; does it reach a stop?");
      } else {
        next_slide();
      }
      torque = held();
      return;
    }
    constexpr double kRaise = 1.05;
    push_force_ = std::min(kRaise * push_force_ + 0.01 * axis().force_max, axis().force_max);
    moved_since_s_ = now_s_;
  }
  constexpr std::size_t kSamplesLeast = 10;
  const bool fast = speed() >= target_speed_;
  const double most = now_.silent ? kPushShare : kPushShare + 0.1;
  if (slide_.samples.size() >= kSamplesLeast && (fast || way > most * travel_)) {
    slide_.released = slide_.samples.size();
    release_speed_ = speed();
    enter(State::coast);
    coast_tick(torque);
    return;
  }
  torque[joint_] = slide_.direction * push_force_;
  slide_.samples.push_back({now_s_, way, commanded_s_, push_force_});
}

void Guide::coast_tick(Vector& torque) {
  torque[joint_] = 0;
  slide_.samples.push_back({now_s_, progress(), commanded_s_, 0});
  constexpr double kLeast_s = 0.02;
  constexpr double kMost_s = 2;
  constexpr double kSlowShare = 0.12;
  constexpr double kBrakeShare = 0.6;
  const double elapsed_s = now_s_ - since_s_;
  if (elapsed_s < kLeast_s) return;
  const double brake_way = speed() * speed() * record().guess.mass / (2 * kBrakeShare * axis().force_max);
  const bool over = progress() + brake_way > travel_ || elapsed_s > (now_.silent ? kSilence_s : kMost_s);
  if (speed() > kSlowShare * release_speed_ && !over) return;
  if (over) slide_.still_pushed = still_pushed(slide_, record().guess);
  end_slide();
  torque[joint_] = 0;
}

void Guide::end_slide() {
  unmoved_ = 0;
  record().slides.push_back(std::move(slide_));
  slide_ = {.joint = joint_, .direction = record().slides.back().direction};
  const std::size_t count = record().slides.size();
  refit_due_ = count == 4 || count == 8 || count == 16 || planned_ == plan_.size();
  next_slide();
}

void Guide::refit() {
  const auto fit = fit_releases(record().slides, step(), record().guess);
  if (!fit) return;
  JointGuess& guess = record().guess;
  constexpr double kSane = 8;
  if (fit->mass > kSane * guess.mass || fit->mass < guess.mass / kSane) return;
  guess = {.mass = fit->mass,
           .damping = std::max(fit->damping, 0.0),
           .friction = std::max(fit->friction, 0.0),
           .latency_s = std::max(fit->latency_s.value, 0.0)};
  if (fit->hold_s) guess.hold_s = fit->hold_s->value;
  for (Slide& slide : record().slides) slide.still_pushed = still_pushed(slide, guess);
}

/// More slides of the joint that tells latency and hold time best, until both are known well enough.
void Guide::plan_more() {
  double best_s = 1;
  for (int i = 0; i < declared_.degrees_of_freedom(); ++i) {
    if (extra_joint_ >= 0 && i != extra_joint_) continue;
    const JointRecord& candidate = records_[static_cast<std::size_t>(i)];
    if (!candidate.refused.empty()) continue;
    const auto fit =
        fit_releases(candidate.slides, axes_[static_cast<std::size_t>(i)].grid.step().value_or(0), candidate.guess);
    if (!fit) continue;
    const double error_s = std::max(fit->latency_s.error, fit->hold_s ? fit->hold_s->error : 0);
    if (error_s < best_s) {
      best_s = error_s;
      extra_joint_ = i;
    }
  }
  if (extra_joint_ < 0 || best_s < kDelayErrorGoal_s || extra_ >= kExtraMost) {
    joint_ = 0;
    enter(State::finished);
    return;
  }
  joint_ = extra_joint_;
  extra_ += kExtraAtOnce;
  plan_.clear();
  planned_ = 0;
  for (int i = 0; i < kExtraAtOnce; ++i) plan_.push_back({1, i % 4 > 1});
  next_slide();
}

ReadingFacts Guide::readings() const {
  ReadingFacts facts = readings_;
  for (const Axis& axis : axes_) facts.encoder_step.push_back(axis.grid.step().value_or(0));
  return facts;
}

double Guide::share() const noexcept {
  if (state_ == State::finished) return 1;
  constexpr double kPlanned = 36;
  constexpr double kExtraShare = 0.1;
  const auto dof = static_cast<double>(declared_.degrees_of_freedom());
  if (extra_joint_ >= 0) return 1 - kExtraShare * (1 - static_cast<double>(extra_) / kExtraMost);
  const double here = std::min(static_cast<double>(planned_) / kPlanned, 1.0);
  return (1 - kExtraShare) * (std::clamp(joint_, 0, declared_.degrees_of_freedom() - 1) + here) / dof;
}

std::string Guide::doing() const {
  if (state_ == State::rest) return "at rest, without force";
  if (state_ == State::finished) return "done";
  const std::string name = joint_name(joint_, declared_.cartesian);
  if (state_ == State::grow || state_ == State::first_push) return name + ": the force grows until it moves";
  return name + ": slide " + std::to_string(record().slides.size() + 1) + (now_.silent ? ", let go by silence" : "");
}

}  // namespace forcebound::lab::identify
