#pragma once

#include <string>

namespace forcebound::device {

/// What tells of the units that a recorded motion is in.
struct RecordedPace {
  double interval_s = 0;         ///< between rows, in the mean
  double period_s = 1e-3;        ///< between rows, as expected
  double speed_m_per_s_max = 0;  ///< from row to row
};

/// Words for a motion that no hand makes, with the unit that its file is likely to have: "moves at up to 52 m/s: are
/// its positions in mm?". Empty: there is nothing to doubt. Doubted are speeds of 3 m/s or more, and intervals of 1,000
/// times the period or a thousandth of it.
[[nodiscard]] std::string doubt_of_units(const RecordedPace& pace);

}  // namespace forcebound::device
