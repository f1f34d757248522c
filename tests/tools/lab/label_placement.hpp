#pragma once

#include <string>
#include <vector>

namespace forcebound::lab {

/// A rectangle in pixels, y downwards.
struct Box {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;

  [[nodiscard]] bool overlaps(const Box& other) const noexcept {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  [[nodiscard]] bool within(const Box& other) const noexcept {
    return left >= other.left && right <= other.right && top >= other.top && bottom <= other.bottom;
  }
};

/// A point with a name that is to stand beside it.
struct NamedPoint {
  double x = 0;
  double y = 0;
  std::string name{};  ///< empty: only a point not to cover
};

/// A name's box, and whether it is so far from its point that a line must connect them.
struct PlacedName {
  std::string name;
  Box box;
  bool joined = false;
  double x = 0;  ///< of its point
  double y = 0;
};

/// Puts each name where it covers neither another name nor a point, as near as it can: beside its point, then further
/// and further around it, all within `area`. Where there is no such place, on the nearest that covers no name.
[[nodiscard]] std::vector<PlacedName> place_names(const std::vector<NamedPoint>& points, const Box& area);

}  // namespace forcebound::lab
