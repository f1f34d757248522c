#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace forcebound::record {

/// Mean, population variance and maximum of a stream of numbers, by Welford's recursion, which does not cancel.
///
/// Real time: `add` is noexcept and allocates nothing.
class RunningStatistics {
 public:
  void add(double value) noexcept {
    ++count_;
    const double from_old = value - mean_;
    mean_ += from_old / static_cast<double>(count_);
    squares_ += from_old * (value - mean_);
    max_ = std::max(max_, value);
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

  /// NaN, as the others, when there is no value.
  [[nodiscard]] double mean() const noexcept { return count_ == 0 ? kNone : mean_; }
  [[nodiscard]] double variance() const noexcept {
    return count_ == 0 ? kNone : squares_ / static_cast<double>(count_);
  }
  [[nodiscard]] double max() const noexcept { return count_ == 0 ? kNone : max_; }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::uint64_t count_ = 0;
  double mean_ = 0;
  double squares_ = 0;
  double max_ = -std::numeric_limits<double>::infinity();
};

}  // namespace forcebound::record
