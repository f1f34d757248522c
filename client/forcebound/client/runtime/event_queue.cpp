#include "forcebound/client/runtime/event_queue.hpp"

#include <boost/lockfree/spsc_queue.hpp>

namespace forcebound::client {

struct EventQueue::Queue {
  static constexpr std::size_t kCapacity = 256;
  boost::lockfree::spsc_queue<Event> events{kCapacity};
};

EventQueue::EventQueue() : queue_(std::make_unique<Queue>()) {}
EventQueue::~EventQueue() = default;

void EventQueue::on_event(const Event& event) noexcept {
  if (!queue_->events.push(event)) dropped_.fetch_add(1, std::memory_order_relaxed);
}

bool EventQueue::take(Event& event) noexcept { return queue_->events.pop(event); }

}  // namespace forcebound::client
