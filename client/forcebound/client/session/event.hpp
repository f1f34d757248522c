#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "forcebound/control/follower_state.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// An event to report to the user. Fixed size: the tick hands it to another thread for printing.
struct Event {
  enum class Kind : std::uint8_t {
    welcomed,            ///< text: the scene and its summary
    refused,             ///< text: the server's reason
    session_unknown,     ///< the server restarted or has dropped the session
    server_left,         ///< the server ended the session
    force_fading,        ///< forces are older than the hold time; `duration` is the age
    force_dropped,       ///< ... than the drop time
    force_fresh,         ///< forces are fresh again; `duration` is the time without fresh forces
    scene_here,          ///< all pieces of the scene that runs at the client have arrived
    scene_refused,       ///< the scene that the server handed over; text: the error
    limited_for_safety,  ///< a limit for the hand began to act; text: which, and what ends it
    device_gone,         ///< the device gives no readings; text: why
    no_torque,           ///< the device tells its orientation, but has no motors to turn it; text: its name
    device_back,         ///< it does again; `duration` is the time without
    follower_changed,    ///< the robot at the far end does something else: `follower`; text: how the operator engages
    tool_lost,           ///< the scene has a tool in the hand, and the device does not tell its orientation
  };

  Kind kind = Kind::welcomed;
  time::Nanoseconds time{0};
  time::Nanoseconds duration{0};
  control::FollowerState follower = control::FollowerState::none;
  std::array<char, 1024> text{};
  std::size_t text_bytes = 0;

  /// Copies the server's text, truncated to the buffer and with control characters replaced.
  void set_text(std::string_view words) noexcept {
    text_bytes = std::min(words.size(), text.size());
    std::copy_n(words.begin(), text_bytes, text.begin());
    text::make_printable(std::span(text).first(text_bytes));
  }
  [[nodiscard]] std::string_view words() const noexcept { return {text.data(), text_bytes}; }
};

/// Called by the tick: noexcept, no allocation, never waits.
class EventSink {
 public:
  virtual ~EventSink() = default;
  virtual void on_event(const Event& event) noexcept = 0;
};

}  // namespace forcebound::client
