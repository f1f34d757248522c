#pragma once

#include <string_view>

#include "forcebound/client/session/event.hpp"

namespace forcebound::client {

/// Reports the events of a session to its sink; all stages of the session use the same.
///
/// Real time: noexcept, no allocation.
class EventReporter {
 public:
  /// @param sink null: nobody is told
  explicit EventReporter(EventSink* sink) noexcept : sink_(sink) {}

  void report(Event::Kind kind, time::Nanoseconds now, std::string_view words = {},
              time::Nanoseconds duration = {}) noexcept {
    if (sink_ == nullptr) return;
    event_.kind = kind;
    event_.time = now;
    event_.duration = duration;
    event_.set_text(words);
    sink_->on_event(event_);
  }

  /// @param words how the operator engages
  void report_follower(control::FollowerState state, time::Nanoseconds now, std::string_view words) noexcept {
    event_.follower = state;
    report(Event::Kind::follower_changed, now, words);
  }

 private:
  EventSink* sink_;
  Event event_;
};

}  // namespace forcebound::client
