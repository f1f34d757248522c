#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/client/commands/doctor/clock_drift.hpp"
#include "forcebound/client/commands/doctor/doctor_session.hpp"
#include "forcebound/client/session/force_stream.hpp"

namespace forcebound::client::commands {

/// Percentiles of delays [ms]; all zero where there are none.
struct Delays {
  std::uint64_t count = 0;
  double p50_ms = 0;
  double p90_ms = 0;
  double p99_ms = 0;
  double p999_ms = 0;
  double max_ms = 0;
};

/// By the nearest rank (time::percentile_ranks).
[[nodiscard]] Delays delays_of(std::vector<double> values_ms);

/// What became of the datagrams of one direction.
struct WayFindings {
  std::uint64_t sent = 0;
  std::uint64_t lost = 0;
  std::uint64_t reordered = 0;   ///< came after a newer one
  std::uint64_t duplicated = 0;  ///< further copies that came
  Delays above_least{};          ///< one-way delay above its least: only the two clocks' offset hides the delay itself

  /// Lost of those sent; 0 where none was.
  [[nodiscard]] double loss() const noexcept {
    return sent == 0 ? 0 : static_cast<double>(lost) / static_cast<double>(sent);
  }
};

/// Known from the motions of a session and their answers.
struct NetworkFindings {
  Delays round_trip{};  ///< from the motion to its answer's arrival, with the server's time
  Delays at_server{};   ///< from a motion's arrival there to its answer's leaving
  WayFindings up{};
  WayFindings down{};
  std::uint64_t unanswered = 0;  ///< motions that the server received and answered a newer one instead
  double longest_gap_ms = 0;     ///< without a new force
  std::optional<ClockDrift> drift{};
};

/// @param counts after the end of the session, so that nothing is on its way
[[nodiscard]] NetworkFindings network_findings(std::span<const AnsweredMotion> answers,
                                               const client::ForceStream::Counts& counts, Nanoseconds longest_gap);

}  // namespace forcebound::client::commands
