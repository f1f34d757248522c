#include "forcebound/results/envelope.hpp"

#include <cmath>
#include <limits>

namespace forcebound::results {

Envelope::Envelope(std::size_t curves) : curves_(curves) {
  columns_.reserve(kColumns);
  extents_.reserve(kColumns * curves);
}

Envelope::Extent Envelope::merged(const Extent& first, const Extent& second) noexcept {
  const bool gap = first.gap || second.gap;
  if (std::isnan(first.low)) return {second.low, second.high, second.low_first, gap};
  if (std::isnan(second.low)) return {first.low, first.high, first.low_first, gap};
  const Extent& low = first.low <= second.low ? first : second;
  const Extent& high = first.high >= second.high ? first : second;
  const bool low_first = &low == &high ? low.low_first : &low == &first;
  return {low.low, high.high, low_first, gap};
}

void Envelope::add(double x, std::span<const double> y) noexcept {
  const bool new_column = columns_.empty() || in_last_ == per_column_;
  if (new_column) {
    if (columns_.size() == kColumns) halve();
    columns_.push_back({x, x});
    in_last_ = 0;
  }
  for (std::size_t curve = 0; curve < curves_; ++curve) {
    const bool there = std::isfinite(y[curve]);
    const double value = there ? y[curve] : std::numeric_limits<double>::quiet_NaN();
    const Extent extent{value, value, true, !there};
    if (new_column) {
      extents_.push_back(extent);
    } else {
      Extent& last = extents_[(columns_.size() - 1) * curves_ + curve];
      last = merged(last, extent);
    }
  }
  columns_.back().end = x;
  ++in_last_;
}

void Envelope::halve() noexcept {
  static_assert(kColumns % 2 == 0);
  for (std::size_t to = 0; to < kColumns / 2; ++to) {
    columns_[to] = {columns_[2 * to].begin, columns_[2 * to + 1].end};
    for (std::size_t curve = 0; curve < curves_; ++curve) {
      extents_[to * curves_ + curve] =
          merged(extents_[2 * to * curves_ + curve], extents_[(2 * to + 1) * curves_ + curve]);
    }
  }
  columns_.resize(kColumns / 2);
  extents_.resize(kColumns / 2 * curves_);  // shrinks
  per_column_ *= 2;
}

std::vector<Envelope::Point> Envelope::points() const {
  std::vector<Point> points;
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    const auto extents = extents_of(column);
    const auto [begin, end] = columns_[column];
    Point first{begin, {}};
    Point second{end, {}};
    Point gaps{end, {}};  // a curve with values and a gap ends here
    bool any_gap = false;
    for (const Extent& extent : extents) {
      first.y.push_back(extent.low_first ? extent.low : extent.high);
      second.y.push_back(extent.low_first ? extent.high : extent.low);
      const bool ends = extent.gap && !std::isnan(extent.low);
      gaps.y.push_back(ends ? std::numeric_limits<double>::quiet_NaN() : second.y.back());
      any_gap = any_gap || ends;
    }
    points.push_back(std::move(first));
    if (end > begin) points.push_back(std::move(second));
    if (any_gap) points.push_back(std::move(gaps));
  }
  return points;
}

}  // namespace forcebound::results
