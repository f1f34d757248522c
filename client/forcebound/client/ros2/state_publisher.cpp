#include "forcebound/client/ros2/state_publisher.hpp"

#include <algorithm>

namespace forcebound::ros2 {
namespace {

// Of a tick's time: readings jitter, and a rate of 1000 is that of each.
constexpr Nanoseconds kEarly = std::chrono::microseconds{100};

}  // namespace

StatePublisher::StatePublisher(StateQueue& queue, Topics& topics, const AnswerAges& ages, double rate_Hz)
    : queue_(queue),
      topics_(topics),
      ages_(ages),
      period_(rate_Hz > 0 ? time::from_seconds(1 / rate_Hz) : Nanoseconds::zero()),
      thread_([this] { run(); }) {}

StatePublisher::~StatePublisher() { queue_.close(); }

bool StatePublisher::is_due(Nanoseconds time) noexcept {
  if (period_ == Nanoseconds::zero()) return true;
  if (time < next_ - kEarly) return false;
  next_ = std::max(next_, time - period_) + period_;
  return true;
}

void StatePublisher::run() {
  topics_.publish(OperatingState::disabled, false);
  VelocityWindow velocities;
  for (StateSample sample; queue_.wait_and_take(sample);) {
    const auto velocity = velocities.update(sample);
    const bool usable = sample.position.rows() > 0 && sample.position.allFinite();
    const bool busy = ages_.newest() == record::ForcePolicy::fresh || ages_.newest() == record::ForcePolicy::fading;
    topics_.publish(usable ? OperatingState::enabled : OperatingState::fault, busy);
    if (!is_due(sample.time)) continue;
    topics_.publish(sample, velocity);
    published_.fetch_add(1, std::memory_order_relaxed);
  }
  topics_.publish(OperatingState::disabled, false);
}

}  // namespace forcebound::ros2
