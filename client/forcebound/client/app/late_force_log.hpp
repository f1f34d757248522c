#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/client/session/event.hpp"
#include "forcebound/time/token_bucket.hpp"

namespace forcebound::client {

/// Chooses which changes of the late-force policy get a log line, so that forces whose age swings about the hold time
/// do not flood the log: three at once, and one a second on average. What was left out is counted in the next line, and
/// the last change is always told, if late.
class LateForceLog {
 public:
  struct Line {
    Event::Kind kind;
    time::Nanoseconds duration;  ///< the event's
    std::uint64_t left_out;      ///< changes before it that had no line
  };

  /// Whether the event is a change of the policy, and so to be noted.
  [[nodiscard]] static bool concerns(Event::Kind kind) noexcept {
    return kind == Event::Kind::force_fading || kind == Event::Kind::force_dropped || kind == Event::Kind::force_fresh;
  }

  void note(const Event& event) noexcept;

  /// The line that is due now, if any.
  std::optional<Line> take(time::Nanoseconds now) noexcept;

  /// What has waited, at the end.
  std::optional<Line> take_rest() noexcept;

 private:
  time::TokenBucket lines_{std::chrono::seconds{1}, 3, time::Nanoseconds{0}};
  std::optional<Line> waiting_;
};

}  // namespace forcebound::client
