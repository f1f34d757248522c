#include "forcebound/server/follower/engagement.hpp"

namespace forcebound::server {

FollowerState Engagement::update(const Sample& sample) noexcept {
  const FollowerState before = state_;
  state_ = next(sample);
  begins_ = state_ == FollowerState::following && before != FollowerState::following;
  if (state_ != before) still_since_.reset();
  const bool ended =
      state_ == FollowerState::stopping || state_ == FollowerState::stopped || state_ == FollowerState::failed;
  if (ended && before != state_ && before != FollowerState::stopping) moved_ = false;
  moved_ = moved_ || (sample.silent && !sample.leader_still);
  was_pressed_ = sample.clutch_pressed;
  return state_;
}

FollowerState Engagement::next(const Sample& sample) noexcept {
  using enum FollowerState;
  const bool at_work = state_ == following || state_ == clutched || state_ == holding;
  if (!sample.robot_ready) {
    why_ = "the robot refuses";
    return failed;
  }
  if (state_ == failed) return stopped;
  if (!sample.exceeded.empty() && (at_work || state_ == waiting)) {
    why_ = sample.exceeded;
    return stopping;
  }
  if (at_work && (!sample.silent || *sample.silent > times_.stop)) {
    why_ = sample.silent ? "the leader is silent" : "the leader has left";
    return stopping;
  }
  if (at_work && sample.robot_stopped) {
    why_ = "the robot stopped by itself";
    return stopped;
  }
  if (!sample.reading_usable && state_ != stopping) return state_;
  switch (state_) {
    case waiting:
    case stopped:
      return operator_engages(sample) ? following : state_;
    case clutched:
      return *sample.silent > times_.hold || sample.clutch_pressed ? clutched : following;
    case following:
    case holding:
      return *sample.silent > times_.hold ? holding : sample.clutch_pressed ? clutched : following;
    case stopping:
      return sample.robot_at_rest ? stopped : stopping;
    default:
      return state_;
  }
}

/// Only with a leader that is heard.
bool Engagement::operator_engages(const Sample& sample) noexcept {
  if (!sample.silent || *sample.silent > times_.hold || !sample.exceeded.empty()) {
    still_since_.reset();
    return false;
  }
  if (sample.has_buttons) return was_pressed_ && !sample.clutch_pressed;
  if (!sample.leader_still || !moved_) {
    still_since_.reset();
    return false;
  }
  if (!still_since_) still_since_ = sample.now;
  return sample.now - *still_since_ >= times_.still;
}

}  // namespace forcebound::server
