#include "forcebound/server/robot/task.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace forcebound::server {
namespace {

/// Added to position and velocity.
void add_spiral(const ToolSpiral& spiral, double at_s, ScriptTarget& target) noexcept {
  constexpr double kBack_s = 0.5;
  const double length_s = spiral.end_s - spiral.begin_s;
  if (!(length_s > 0) || at_s <= spiral.begin_s || at_s >= spiral.end_s + kBack_s) return;
  const double growth_m_per_s = spiral.radius_m / length_s;
  const bool grows = at_s < spiral.end_s;
  const double radius_m =
      grows ? growth_m_per_s * (at_s - spiral.begin_s) : spiral.radius_m * (1 - (at_s - spiral.end_s) / kBack_s);
  const double radial_m_per_s = grows ? growth_m_per_s : -spiral.radius_m / kBack_s;
  const double turn_per_s = 2 * std::numbers::pi * spiral.turns / length_s;
  const double angle = turn_per_s * (at_s - spiral.begin_s);
  const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
  const Eigen::Vector3d along(-out.y(), out.x(), 0);
  target.position += radius_m * out;
  target.velocity += radial_m_per_s * out + radius_m * turn_per_s * along;
}

}  // namespace

ScriptTarget Task::target(double at_s) const noexcept {
  if (script.empty()) return {};
  const auto later = std::ranges::upper_bound(script, at_s, {}, &ToolWaypoint::time_s);
  const ToolWaypoint& to = later == script.end() ? script.back() : *later;
  const ToolWaypoint& from = later == script.begin() ? to : *std::prev(later);
  const double length_s = to.time_s - from.time_s;
  const double share = length_s > 0 ? std::clamp((at_s - from.time_s) / length_s, 0.0, 1.0) : 1;
  // Minimum jerk: at rest, and not accelerated, at both ends.
  const double way = share * share * share * (10 + share * (6 * share - 15));
  const double speed = length_s > 0 ? 30 * share * share * (1 - share) * (1 - share) / length_s : 0;
  ScriptTarget target{.position = from.position + way * (to.position - from.position),
                      .velocity = speed * (to.position - from.position),
                      .rotation = from.rotation + way * (to.rotation - from.rotation),
                      .grip = from.grip};
  add_spiral(spiral, at_s, target);
  return target;
}

}  // namespace forcebound::server
