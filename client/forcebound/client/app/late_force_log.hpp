#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/client/session/event.hpp"
#include "forcebound/time/token_bucket.hpp"

namespace forcebound::client {

/// Limits the log lines on changes of the late-force policy, so that forces whose age varies about the hold time do not
/// flood the log: three at once, and one a second on average. The next line gives the number left out; the last change
/// always gets its line, perhaps late.
class LateForceLog {
 public:
  struct Line {
    Event::Kind kind;
    time::Nanoseconds duration;  ///< of the event
    std::uint64_t left_out;      ///< changes before it that had no line
  };

  /// Whether the event is a change of the policy.
  [[nodiscard]] static bool concerns(Event::Kind kind) noexcept {
    return kind == Event::Kind::force_fading || kind == Event::Kind::force_dropped || kind == Event::Kind::force_fresh;
  }

  void store(const Event& event) noexcept;

  /// The line that is due now, if any.
  std::optional<Line> take(time::Nanoseconds now) noexcept;

  /// The line that still waits at the end.
  std::optional<Line> take_rest() noexcept;

 private:
  time::TokenBucket lines_{std::chrono::seconds{1}, 3, time::Nanoseconds{0}};
  std::optional<Line> waiting_;
};

}  // namespace forcebound::client
