#pragma once

#include <optional>
#include <span>

#include "forcebound/client/session/clock_offset.hpp"

namespace forcebound::client::commands {

/// How much faster the server's clock goes than the client's.
struct ClockDrift {
  double ppm = 0;
  double uncertain_ppm = 0;  ///< as far as it may be off
};

/// Estimated from exchanges of motions and answers in the order of their arrival: of each tenth of the time the one
/// with the least delay, of which the middle of both ways gives the offset of the clocks (client::ClockOffset), and a
/// straight line through these by least squares. By how much delays of unequal ways shift the offset does not matter,
/// as long as it stays the same. What each of these exchanges took longer than the shortest of all may have been on one
/// way alone; that, and twice the scatter about the line, is what the drift may be off.
///
/// None where there are exchanges in fewer than three tenths, or within less than a tenth of a second.
[[nodiscard]] std::optional<ClockDrift> clock_drift(std::span<const client::ClockOffset::Exchange> exchanges);

}  // namespace forcebound::client::commands
