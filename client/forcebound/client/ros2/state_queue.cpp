#include "forcebound/client/ros2/state_queue.hpp"

namespace forcebound::ros2 {

StateQueue::StateQueue() {
  // Touched here, not in the tick: the first use of a page of memory costs a fault.
  while (waiting_.push(StateSample{})) {
  }
  waiting_.consume_all([](const StateSample&) {});
}

void StateQueue::push(const StateSample& sample) noexcept {
  if (!waiting_.push(sample)) dropped_.fetch_add(1, std::memory_order_relaxed);
  changes_.fetch_add(1, std::memory_order_release);
  changes_.notify_one();
}

void StateQueue::on_tick(const record::TickRecord& tick) noexcept {
  push({.time = tick.time,
        .position = tick.position,
        .joint = tick.joint,
        .force_N = tick.applied,
        .torque_N_m = tick.applied_torque_N_m,
        .handle = tick.handle});
}

bool StateQueue::wait_and_take(StateSample& sample) noexcept {
  for (;;) {
    const std::uint32_t seen = changes_.load(std::memory_order_acquire);
    const bool closed = closed_.load(std::memory_order_acquire);
    if (pop_newest(sample)) return true;
    if (closed) return false;
    changes_.wait(seen, std::memory_order_acquire);
  }
}

/// The oldest of the last ten.
bool StateQueue::pop_newest(StateSample& sample) noexcept {
  std::size_t waiting = waiting_.read_available();
  for (; waiting > kKept && waiting_.pop(sample); --waiting) dropped_.fetch_add(1, std::memory_order_relaxed);
  return waiting_.pop(sample);
}

void StateQueue::close() noexcept {
  closed_.store(true, std::memory_order_release);
  changes_.fetch_add(1, std::memory_order_release);
  changes_.notify_one();
}

}  // namespace forcebound::ros2
