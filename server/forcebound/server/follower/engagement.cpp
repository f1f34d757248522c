#include "forcebound/server/follower/engagement.hpp"

namespace forcebound::server {

FollowerState Engagement::update(const Seen& seen) noexcept {
  const FollowerState before = state_;
  state_ = next(seen);
  begins_ = state_ == FollowerState::following && before != FollowerState::following;
  if (state_ != before) still_since_.reset();
  const bool ended =
      state_ == FollowerState::stopping || state_ == FollowerState::stopped || state_ == FollowerState::failed;
  if (ended && before != state_ && before != FollowerState::stopping) moved_ = false;
  moved_ = moved_ || (seen.silent && !seen.leader_still);
  was_pressed_ = seen.clutch_pressed;
  return state_;
}

FollowerState Engagement::next(const Seen& seen) noexcept {
  using enum FollowerState;
  const bool at_work = state_ == following || state_ == clutched || state_ == holding;
  if (!seen.robot_ready) {
    why_ = "the robot refuses";
    return failed;
  }
  if (state_ == failed) return stopped;
  if (!seen.exceeded.empty() && (at_work || state_ == waiting)) {
    why_ = seen.exceeded;
    return stopping;
  }
  if (at_work && (!seen.silent || *seen.silent > times_.stop)) {
    why_ = seen.silent ? "the leader is silent" : "the leader has left";
    return stopping;
  }
  if (at_work && seen.robot_stopped) {
    why_ = "the robot stopped by itself";
    return stopped;
  }
  if (!seen.reading_usable && state_ != stopping) return state_;
  switch (state_) {
    case waiting:
    case stopped:
      return operator_engages(seen) ? following : state_;
    case clutched:
      return *seen.silent > times_.hold || seen.clutch_pressed ? clutched : following;
    case following:
    case holding:
      return *seen.silent > times_.hold ? holding : seen.clutch_pressed ? clutched : following;
    case stopping:
      return seen.robot_at_rest ? stopped : stopping;
    default:
      return state_;
  }
}

/// Only with a leader that is heard.
bool Engagement::operator_engages(const Seen& seen) noexcept {
  if (!seen.silent || *seen.silent > times_.hold || !seen.exceeded.empty()) {
    still_since_.reset();
    return false;
  }
  if (seen.has_buttons) return was_pressed_ && !seen.clutch_pressed;
  if (!seen.leader_still || !moved_) {
    still_since_.reset();
    return false;
  }
  if (!still_since_) still_since_ = seen.now;
  return seen.now - *still_since_ >= times_.still;
}

}  // namespace forcebound::server
