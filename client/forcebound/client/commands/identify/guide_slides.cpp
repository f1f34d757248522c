// The motion of one joint: the force grows until it moves, then its slides.
#include <algorithm>
#include <cmath>
#include <utility>

#include "forcebound/client/commands/identify/first_guess.hpp"
#include "forcebound/client/commands/identify/guide.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client::commands::identify {
namespace {

constexpr double kGrow_s = 1.5;       // until the force has grown to the most
constexpr double kGivenUp_s = 0.3;    // at the most without motion
constexpr double kSilence_s = 0.15;   // no device holds a force for longer without saying so
constexpr double kPushShare = 0.45;   // of the way, for the push
constexpr double kDampedShare = 0.7;  // of the speed sought, on average while pushed
constexpr int kUnmovedMost = 4;

}  // namespace

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
  torque[joint_] = risen(joint_, push_force_);
  // Only under the whole force, which is constant.
  if (torque[joint_] < push_force_) return;
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
  plan_joint();
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
  if (std::exchange(refit_due_, false)) {
    begin_work(Work::refit);
  } else if (std::exchange(joint_done_, false)) {
    if (extra_joint_ >= 0) {
      begin_work(Work::times);
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
  torque_last_[joint_] = 0;
  release_in_ = -1;
  enter(State::push);
}

/// A slide that ended as soon as its readings say that it is fast enough would end more often where they are rounded
/// up: then rounding is no chance any more, and what is fitted is off by far more than its scatter tells.
int Guide::some_ticks() {
  constexpr int kMost = 8;
  return 2 + static_cast<int>(random_() % kMost);
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
  constexpr int kSamplesLeast = 10;
  const bool fast = speed() >= target_speed_;
  const double most = now_.silent ? kPushShare : kPushShare + 0.1;
  if (release_in_ < 0 && constant_ticks_ >= kSamplesLeast && (fast || way > most * travel_)) release_in_ = some_ticks();
  if (release_in_ >= 0 && release_in_-- == 0) {
    slide_.released = slide_.samples.size();
    release_speed_ = speed();
    end_in_ = -1;
    enter(State::coast);
    coast_tick(torque);
    return;
  }
  torque[joint_] = risen(joint_, slide_.direction * push_force_);
  const double force = std::abs(torque[joint_]);
  constant_ticks_ = !slide_.samples.empty() && force == slide_.samples.back().force ? constant_ticks_ + 1 : 0;
  slide_.samples.push_back({now_s_, way, commanded_s_, force});
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
  if (end_in_ < 0 && speed() <= kSlowShare * release_speed_) end_in_ = some_ticks();
  const bool slow = end_in_ >= 0 && end_in_-- == 0;
  if (!slow && !over) return;
  if (over) slide_.still_pushed = still_pushed(slide_, record().guess);
  end_slide();
  torque[joint_] = 0;
}

}  // namespace forcebound::client::commands::identify
