#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "tests/tools/netem/verdict.hpp"

namespace forcebound::relay {

using netem::Direction;
using time::Nanoseconds;

/// Turns a relay's observations into CSV rows, one per packet and copy, each direction in the order of arrival: so one
/// seed gives the same rows of a direction whatever the machine's timing, except for `time_ms`.
///
///     direction,number,time_ms,verdict,delay_ms
///     up,1,12.500000,forwarded,53.120417
///     up,2,13.500000,lost,
///
/// `time_ms` counts from the relay's start. A row is ready once its delay is final; packets that have not left by the
/// end are "waiting".
class PacketRows {
 public:
  static constexpr std::string_view kHeader = "direction,number,time_ms,verdict,delay_ms\n";

  explicit PacketRows(Nanoseconds start) : start_(start) {}

  void on_verdict(Direction direction, const netem::Verdict& verdict);
  void on_departure(Direction direction, const netem::Verdict& verdict);

  /// Appends the rows that are ready to `text`; returns their number.
  std::size_t take_ready(std::string& text);

  /// The same for all rows, at the end.
  std::size_t take_all(std::string& text);

 private:
  struct Row {
    netem::Verdict verdict;
    bool complete;
  };
  using Rows = std::deque<Row>;

  void write(std::string& text, Direction direction, const Row& row) const;
  std::size_t take(std::string& text, bool incomplete_too);

  Nanoseconds start_;
  std::array<Rows, 2> rows_;
};

}  // namespace forcebound::relay
