#include "forcebound/server/robot/command_queue.hpp"

#include <algorithm>

namespace forcebound::server {

CommandQueue::CommandQueue(const control::DeviceFacts& facts) noexcept
    : latency_(time::from_seconds(facts.latency_s)),
      hold_(time::from_seconds(facts.hold_s_max)),
      torque_(Vector::Zero(facts.joints())) {}

void CommandQueue::command(Nanoseconds now, const Vector& torque) noexcept {
  count_ = std::min(count_ + 1, kWaitingMax);
  waiting_[count_ - 1] = {.effect = now + latency_, .torque = torque};
  released_.reset();
  pass(now);
}

void CommandQueue::drop(Nanoseconds now) noexcept {
  count_ = 0;
  torque_.setZero();
  release_.reset();
  released_ = now;
}

Nanoseconds CommandQueue::next_change(Nanoseconds now, Nanoseconds latest) const noexcept {
  Nanoseconds next = latest;
  if (count_ > 0) next = std::min(next, waiting_[0].effect);
  if (release_) next = std::min(next, *release_);
  return std::max(next, now);
}

void CommandQueue::pass(Nanoseconds now) noexcept {
  for (;;) {
    const bool takes_effect = count_ > 0 && waiting_[0].effect <= now;
    const bool lets_go = release_ && *release_ <= now && (!takes_effect || *release_ <= waiting_[0].effect);
    if (lets_go) {
      torque_.setZero();
      if (count_ == 0) released_ = release_;
      release_.reset();
    } else if (takes_effect) {
      torque_ = waiting_[0].torque;
      release_ = waiting_[0].effect + hold_;
      std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(count_), waiting_.begin());
      --count_;
    } else {
      return;
    }
  }
}

}  // namespace forcebound::server
