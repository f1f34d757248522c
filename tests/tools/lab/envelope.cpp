#include <cmath>
#include <limits>

#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {

void Envelope::add(double x, double y) noexcept {
  if (!std::isfinite(x) || !std::isfinite(y)) {
    gap_ = true;
    return;
  }
  const bool full = columns_.empty() || in_last_ == per_column_;
  if (full || gap_) {
    if (columns_.size() == columns_.capacity()) halve();
    columns_.push_back({{x, y}, {x, y}, gap_});
    in_last_ = 1;
    gap_ = false;
    return;
  }
  Column& last = columns_.back();
  if (y < last.low.y) last.low = {x, y};
  if (y > last.high.y) last.high = {x, y};
  ++in_last_;
}

void Envelope::halve() noexcept {
  merge_pairs(Gaps::kept);
  // A curve of mostly gaps would otherwise find no room.
  if (columns_.size() > columns_.capacity() * 3 / 4) merge_pairs(Gaps::closed);
  per_column_ *= 2;
}

void Envelope::merge_pairs(Gaps gaps) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column a = columns_[i];
    const bool alone = i + 1 == columns_.size() || (gaps == Gaps::kept && columns_[i + 1].gap);
    if (alone) {
      columns_[kept++] = a;
      continue;
    }
    const Column b = columns_[++i];
    columns_[kept++] = {a.low.y <= b.low.y ? a.low : b.low, a.high.y >= b.high.y ? a.high : b.high, a.gap || b.gap};
  }
  columns_.resize(kept, Column{});  // shrinks
}

Series Envelope::series(std::string label, const char* colour) const {
  Series series{std::move(label), {}, {}, colour};
  const auto put = [&series](const Point& point) {
    series.x.push_back(point.x);
    series.y.push_back(point.y);
  };
  for (const Column& column : columns_) {
    const bool rising = column.low.x <= column.high.x;
    const Point& first = rising ? column.low : column.high;
    const Point& second = rising ? column.high : column.low;
    if (column.gap) put({first.x, std::numeric_limits<double>::quiet_NaN()});
    put(first);
    if (second.x > first.x) put(second);
  }
  return series;
}

}  // namespace forcebound::lab
