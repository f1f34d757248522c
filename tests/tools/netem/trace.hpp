#pragma once

#include <filesystem>
#include <istream>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "forcebound/time/clock.hpp"

namespace forcebound::netem {

using time::Nanoseconds;

/// A network's delay as it was measured: round-trip times by the time of sending.
///
/// Half of the round trip applies each way, interpolated between rows. A hole of more than kBlackoutHole between two
/// rows is a blackout: nothing sent in it came back. After its last row the trace starts over.
class RttTrace {
 public:
  struct Sample {
    Nanoseconds send_time;
    Nanoseconds round_trip;
  };
  static constexpr Nanoseconds kBlackoutHole = std::chrono::seconds(1);

  /// @throws std::invalid_argument unless there is a sample, times never decrease and no round trip is negative.
  explicit RttTrace(std::vector<Sample> samples);

  /// Delay of a packet sent `elapsed` after the trace's beginning, or nothing in a blackout. Allocates nothing.
  [[nodiscard]] std::optional<Nanoseconds> one_way_delay(Nanoseconds elapsed) const noexcept;

  /// From the first row to the last.
  [[nodiscard]] Nanoseconds duration() const noexcept;

 private:
  std::vector<Sample> samples_;
};

/// When a link could deliver, as mahimahi records it: each entry is the moment of one opportunity of kOpportunityBytes.
/// Unused opportunities are lost; after its last entry the schedule starts over.
class DeliveryTrace {
 public:
  static constexpr std::size_t kOpportunityBytes = 1500;

  /// @throws std::invalid_argument unless there is an opportunity, times never decrease and the last is after 0.
  explicit DeliveryTrace(std::vector<Nanoseconds> opportunities);

  [[nodiscard]] const std::vector<Nanoseconds>& opportunities() const noexcept { return opportunities_; }
  [[nodiscard]] Nanoseconds period() const noexcept { return opportunities_.back(); }

 private:
  std::vector<Nanoseconds> opportunities_;
};

using NetworkTrace = std::variant<RttTrace, DeliveryTrace>;

/// Reads a trace: CSV if it begins with the header `send_time_ms,rtt_ms`, else mahimahi (one whole millisecond per
/// line). `name` is used in errors.
///
/// @throws std::runtime_error `name:line: what, what would be accepted`.
NetworkTrace read_trace(std::istream& text, const std::string& name);

/// @throws std::runtime_error as `read_trace`, and if the file cannot be opened.
NetworkTrace load_trace(const std::filesystem::path& file);

}  // namespace forcebound::netem
