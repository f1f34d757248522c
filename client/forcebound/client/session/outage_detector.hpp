#pragma once

#include <cstdint>
#include <optional>

#include "forcebound/record/blackout.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// The counts of both ends of a session, as of a force or a Bye.
struct Progress {
  std::uint64_t session = 0;
  std::uint64_t motions_made = 0;     ///< number of the motion answered; at a Bye, of the last motion
  std::uint64_t motions_arrived = 0;  ///< at the server, by its own count
  std::uint64_t answers_sent = 0;     ///< by the server, by its own count
  std::uint64_t answers_arrived = 0;

  friend bool operator==(const Progress&, const Progress&) noexcept = default;
};

/// Detects blackouts: no new force for longer than the policy's hold time. Keeps the longest with its losses:
/// record::Blackout.
///
/// Real time: noexcept, no allocation, O(1).
class OutageDetector {
 public:
  explicit OutageDetector(Nanoseconds hold) : hold_(hold) {}

  /// Called for a force that is newer than all before.
  void on_force(Nanoseconds now, const Progress& progress) noexcept;

  enum class Bye : std::uint8_t { of_the_server, answers_ours };
  void on_bye(Nanoseconds now, const Progress& progress, Bye kind) noexcept;

  /// The longest blackout so far, the present one included.
  [[nodiscard]] record::Blackout longest(Nanoseconds now) const noexcept;

 private:
  struct Force {
    Nanoseconds time;
    Progress progress;
  };

  [[nodiscard]] bool in_blackout(Nanoseconds now) const noexcept { return last_ && now - last_->time > hold_; }

  Nanoseconds hold_;
  std::optional<Force> last_;
  record::Blackout present_;  // the blackout since last_
  record::Blackout longest_;
};

}  // namespace forcebound::client
