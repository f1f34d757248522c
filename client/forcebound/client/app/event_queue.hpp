#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>

#include "forcebound/client/session/event.hpp"

namespace forcebound::client {

/// Carries events from the tick to the thread that logs them.
///
/// Real time: `on_event` is noexcept, allocates nothing and never waits; a full queue drops the event and counts it.
class EventQueue final : public EventSink {
 public:
  void on_event(const Event& event) noexcept override {
    if (!queue_.push(event)) dropped_.fetch_add(1, std::memory_order_relaxed);
  }

  bool take(Event& event) noexcept { return queue_.pop(event); }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kCapacity = 256;
  boost::lockfree::spsc_queue<Event> queue_{kCapacity};
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace forcebound::client
