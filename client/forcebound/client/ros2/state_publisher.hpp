#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/client/ros2/topic_environment.hpp"
#include "forcebound/client/ros2/topics.hpp"

namespace forcebound::ros2 {

/// A thread that publishes what a queue carries, until that is closed; the state of operation is DISABLED before the
/// first and after the last.
class StatePublisher {
 public:
  /// All must outlive it. @param rate_Hz the most of samples a second; 0: all
  StatePublisher(StateQueue& queue, Topics& topics, const AnswerAges& ages, double rate_Hz);
  /// Closes the queue, and publishes what waits there.
  ~StatePublisher();
  StatePublisher(const StatePublisher&) = delete;
  StatePublisher& operator=(const StatePublisher&) = delete;

  /// Samples. Any thread.
  [[nodiscard]] std::uint64_t published() const noexcept { return published_.load(std::memory_order_relaxed); }

 private:
  void run();
  [[nodiscard]] bool is_due(Nanoseconds time) noexcept;

  StateQueue& queue_;
  Topics& topics_;
  const AnswerAges& ages_;
  Nanoseconds period_;
  Nanoseconds next_{0};
  std::atomic<std::uint64_t> published_{0};
  std::jthread thread_;  // last, so that it ends before what it uses
};

}  // namespace forcebound::ros2
