#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace forcebound::control {

/// A function of s >= 0 that begins at 0, never falls, and is made of parabolas: what forces need, over their size.
///
/// Real time: noexcept, no allocation, O(Room^2) for all that is added. A value.
/// @tparam Room how often `bend` may be called
template <std::size_t Room>
class ParabolaSum {
 public:
  /// Adds slope (s - begin) 2 + curvature (s - begin)^2 from `begin` on.
  void bend(double begin, double slope, double curvature) noexcept {
    auto place = bends_.begin() + count_++;
    for (; place != bends_.begin() && begin < (place - 1)->begin; --place) *place = *(place - 1);
    *place = {begin, slope, curvature};
  }

  /// The largest s at which the function is at most `room` >= 0; infinity if it is everywhere.
  [[nodiscard]] double reach(double room) const noexcept {
    // With t = s - begin:  a t^2 + 2 b t = room,  moved on from bend to bend.
    double a = 0;
    double b = 0;
    double begin = 0;
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      const Bend& newest = bends_[static_cast<std::size_t>(i)];
      const double ahead = i == 0 ? 0 : newest.begin - begin;
      begin = newest.begin;
      room -= (a * ahead + 2 * b) * ahead;
      b += a * ahead + newest.slope;
      a += newest.curvature;
      // Roots before the product: a * room underflows where little is left, and nothing would then bound the force.
      const double root = std::hypot(b, std::sqrt(std::max(a, 0.0)) * std::sqrt(std::max(room, 0.0)));
      const double s = begin + (room > 0 ? room / (b + root) : 0.0);
      if (i + 1 == count_ || s <= bends_[static_cast<std::size_t>(i + 1)].begin) return s;
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  struct Bend {
    double begin = 0;
    double slope = 0;
    double curvature = 0;
  };
  std::array<Bend, Room> bends_{};  // sorted by where they begin
  std::ptrdiff_t count_ = 0;
};

}  // namespace forcebound::control
