#include "tests/tools/lab/label_placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace forcebound::lab {
namespace {

// DejaVu Sans of 10 points.
constexpr double kCharacter_px = 7.2;
constexpr double kHeight_px = 15;
constexpr double kPoint_px = 7;  // half of a point's mark
constexpr double kJoinedFrom_px = 20;

Box box_at(const NamedPoint& point, double distance_px, double angle_rad) {
  const double width = kCharacter_px * static_cast<double>(point.name.size());
  const double along = std::cos(angle_rad);
  // The box touches the circle of that distance from outside, on the side where the angle points.
  const double middle_x = point.x + along * (distance_px + width / 2);
  const double middle_y = point.y - std::sin(angle_rad) * (distance_px + kHeight_px / 2);
  return {middle_x - width / 2, middle_y - kHeight_px / 2, middle_x + width / 2, middle_y + kHeight_px / 2};
}

bool is_free(const Box& box, const std::vector<NamedPoint>& points, const std::vector<PlacedName>& placed) {
  const bool on_name = std::ranges::any_of(placed, [&](const PlacedName& other) { return box.overlaps(other.box); });
  return !on_name && std::ranges::none_of(points, [&](const NamedPoint& point) {
    return box.overlaps({point.x - kPoint_px, point.y - kPoint_px, point.x + kPoint_px, point.y + kPoint_px});
  });
}

PlacedName place(const NamedPoint& point, const std::vector<NamedPoint>& points, const std::vector<PlacedName>& placed,
                 const Box& area) {
  constexpr std::array kTurns{0.0, 0.125, 0.875, 0.5, 0.375, 0.625, 0.25, 0.75};
  constexpr std::array kDistances_px{9.0, 14.0, 24.0, 36.0, 50.0, 70.0, 95.0, 125.0, 160.0};
  PlacedName fallback{point.name, box_at(point, kDistances_px.front(), 0), false, point.x, point.y};
  bool has_fallback = false;
  for (const double distance_px : kDistances_px) {
    for (const double turn : kTurns) {
      const Box box = box_at(point, distance_px, turn * 2 * std::numbers::pi);
      if (!box.within(area)) continue;
      const PlacedName here{point.name, box, distance_px >= kJoinedFrom_px, point.x, point.y};
      if (is_free(box, points, placed)) return here;
      if (has_fallback || !is_free(box, {}, placed)) continue;
      fallback = here;
      has_fallback = true;
    }
  }
  return fallback;
}

}  // namespace

std::vector<PlacedName> place_names(const std::vector<NamedPoint>& points, const Box& area) {
  std::vector<PlacedName> placed;
  for (const NamedPoint& point : points) {
    if (!point.name.empty()) placed.push_back(place(point, points, placed, area));
  }
  return placed;
}

}  // namespace forcebound::lab
