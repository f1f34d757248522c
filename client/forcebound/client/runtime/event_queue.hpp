#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "forcebound/client/session/event.hpp"

namespace forcebound::client {

/// Carries events from the tick to the thread that logs them.
///
/// Real time: `on_event` is noexcept, allocates nothing and never waits; a full queue drops the event and counts it.
class EventQueue final : public EventSink {
 public:
  EventQueue();
  ~EventQueue() override;

  void on_event(const Event& event) noexcept override;

  /// The oldest waiting event, if any.
  bool take(Event& event) noexcept;

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  struct Queue;

  std::unique_ptr<Queue> queue_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace forcebound::client
