#pragma once

#include <string>
#include <vector>

namespace forcebound::device {

/// What the rows of a recorded motion tell of the units that it is in.
class RecordedPace {
 public:
  /// @param period_s between rows, as expected
  explicit RecordedPace(double period_s = 1e-3) : period_s_(period_s) {}

  /// @param interval_s since the row before @param distance_m from its position; no speed if it is not a number
  void add_row(double interval_s, double distance_m);

  /// Words for a motion that no hand makes, with the unit that its file is likely to have: "moves at up to 52 m/s: are
  /// its positions in mm?". Empty: there is nothing to doubt. Doubted are speeds of 3 m/s or more from row to row, and
  /// intervals of 1,000 times the period or a thousandth of it: their median over the first 1,000, so that a hand may
  /// rest for as long as it likes.
  [[nodiscard]] std::string doubt_of_units() const;

 private:
  double period_s_;
  std::vector<double> intervals_s_;
  double speed_m_per_s_max_ = 0;
};

}  // namespace forcebound::device
