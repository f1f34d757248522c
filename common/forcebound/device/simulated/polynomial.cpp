#include "forcebound/device/simulated/polynomial.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace forcebound::device::polynomial {
namespace {

struct End {
  double s;
  double value;
};

// Right ends of the intervals still to be searched; the leftmost is on top. Bisection needs one for each halving.
class Pending {
 public:
  static constexpr int kHalvingsMax = 52;
  void push(End end) noexcept { ends_[static_cast<std::size_t>(count_++)] = end; }
  End pop() noexcept { return ends_[static_cast<std::size_t>(--count_)]; }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }

 private:
  std::array<End, kHalvingsMax + 2> ends_;
  int count_ = 0;
};

/// On an interval of width w the polynomial stays within bound * w^2 of the chord between its ends.
double chord_bound(std::span<const double> c) noexcept {
  double second = 0;
  for (std::size_t k = 2; k < c.size(); ++k) second += static_cast<double>(k * (k - 1)) * std::abs(c[k]);
  return second / 8;
}

/// The same on intervals that end at `s`: near 0 it is far less where the first coefficients are 0, as from rest.
double chord_bound(std::span<const double> c, double s) noexcept {
  double second = 0;
  for (std::size_t k = c.size(); k-- > 2;) second = second * s + static_cast<double>(k * (k - 1)) * std::abs(c[k]);
  return second / 8;
}

}  // namespace

double value(std::span<const double> c, double s) noexcept {
  double sum = 0;
  for (std::size_t k = c.size(); k-- > 0;) sum = sum * s + c[k];
  return sum;
}

std::optional<double> first_negative(std::span<const double> c) noexcept {
  if (c.empty()) return std::nullopt;
  if (c[0] < 0) return 0.0;
  const double bound = chord_bound(c);
  if (!std::isfinite(bound + value(c, 1))) return std::nullopt;  // no bound holds for such coefficients
  constexpr double kWidthLeast = 0x1p-50;
  Pending pending;
  End left{0, c[0]};
  pending.push({1, value(c, 1)});
  while (!pending.empty()) {
    const End right = pending.pop();
    const double width = right.s - left.s;
    const bool proven_clear = std::min(left.value, right.value) >= bound * width * width;
    if (!proven_clear && width > kWidthLeast) {
      const double middle = left.s + 0.5 * width;
      pending.push(right);
      pending.push({middle, value(c, middle)});
      continue;
    }
    if (right.value < 0) return right.s;
    left = right;
  }
  return std::nullopt;
}

double least(std::span<const double> c, double end, double floor) noexcept {
  if (c.empty()) return std::min(floor, 0.0);
  const double bound = chord_bound(c);
  if (!std::isfinite(bound + value(c, end))) return floor;
  constexpr double kWidthLeast = 0x1p-26;  // its square is the promised tolerance
  Pending pending;
  End left{0, c[0]};
  pending.push({end, value(c, end)});
  double best = std::min({floor, left.value, value(c, end)});
  while (!pending.empty()) {
    const End right = pending.pop();
    const double width = right.s - left.s;
    const auto proven = [&](double chord_bound_there) {
      const double reach = chord_bound_there * width * width;
      const bool monotone = std::abs(right.value - left.value) > 8 * reach;
      return monotone || std::min(left.value, right.value) - reach >= best;
    };
    if (width > kWidthLeast && !proven(bound) && !proven(chord_bound(c, right.s))) {
      const End middle{left.s + 0.5 * width, value(c, left.s + 0.5 * width)};
      best = std::min(best, middle.value);
      pending.push(right);
      pending.push(middle);
      continue;
    }
    left = right;
  }
  return best;
}

}  // namespace forcebound::device::polynomial
