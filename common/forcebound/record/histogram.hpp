#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "forcebound/time/percentile.hpp"

namespace forcebound::record {

/// Percentiles of non-negative integers, such as nanoseconds, in memory that does not grow.
///
/// Buckets are log-linear: 1024 to each power of two, so a percentile is off by less than 0.05 % of itself; values
/// below 1024 are exact. Counts of values from 2^46 up (19.5 h in nanoseconds) share the last bucket, negative values
/// the first; `max` is always exact.
///
/// Real time: `add` and `merge` are noexcept and allocate nothing; the constructor allocates 0.3 MB.
class Histogram {
 public:
  Histogram() : counts_(kBuckets) {}

  void add(std::int64_t value) noexcept {
    ++counts_[bucket_of(value)];
    ++count_;
    max_ = std::max(max_, value);
  }

  void merge(const Histogram& other) noexcept {
    for (std::size_t i = 0; i < kBuckets; ++i) counts_[i] += other.counts_[i];
    count_ += other.count_;
    max_ = std::max(max_, other.max_);
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

  /// The largest value, exactly; NaN when there is none.
  [[nodiscard]] double max() const noexcept { return count_ == 0 ? kNone : static_cast<double>(max_); }

  /// The nearest rank, or of an even count the mean of the two middle values, as time::percentile_ranks says; NaN when
  /// there is none.
  /// @param fraction 0 to 1.
  [[nodiscard]] double percentile(double fraction) const noexcept {
    if (count_ == 0) return kNone;
    const auto [low, high] = time::percentile_ranks(fraction, count_);
    std::uint64_t seen = 0;
    double at_low = kNone;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += counts_[i];
      const double value = std::min(middle_of(i), static_cast<double>(max_));
      if (seen >= low && std::isnan(at_low)) at_low = value;
      if (seen >= high) return 0.5 * (at_low + value);
    }
    return static_cast<double>(max_);
  }

 private:
  static constexpr int kBits = 10;
  static constexpr int kBitsMax = 46;
  static constexpr std::size_t kPerOctave = std::size_t{1} << kBits;
  static constexpr std::size_t kBuckets = (kBitsMax - kBits + 1) * kPerOctave;
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  static std::size_t bucket_of(std::int64_t value) noexcept {
    if (value < static_cast<std::int64_t>(kPerOctave))
      return static_cast<std::size_t>(std::max<std::int64_t>(value, 0));
    const auto bits = static_cast<std::uint64_t>(value);
    const int octave = static_cast<int>(std::bit_width(bits)) - 1 - kBits;
    const auto bucket = static_cast<std::size_t>(octave) * kPerOctave + (bits >> octave);
    return std::min(bucket, kBuckets - 1);
  }

  static double middle_of(std::size_t bucket) noexcept {
    if (bucket < kPerOctave) return static_cast<double>(bucket);
    const std::size_t octave = bucket / kPerOctave - 1;
    const std::size_t low = (bucket - octave * kPerOctave) << octave;
    return static_cast<double>(low) + 0.5 * static_cast<double>((std::size_t{1} << octave) - 1);
  }

  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  std::int64_t max_ = std::numeric_limits<std::int64_t>::min();
};

}  // namespace forcebound::record
