#include "forcebound/server/robot/task.hpp"

#include <algorithm>
#include <iterator>

namespace forcebound::server {

ScriptTarget Task::target(double at_s) const noexcept {
  if (script.empty()) return {};
  const auto later = std::ranges::upper_bound(script, at_s, {}, &ToolWaypoint::time_s);
  const ToolWaypoint& to = later == script.end() ? script.back() : *later;
  const ToolWaypoint& from = later == script.begin() ? to : *std::prev(later);
  const double length_s = to.time_s - from.time_s;
  const double share = length_s > 0 ? (at_s - from.time_s) / length_s : 1;
  // Minimum jerk: at rest, and not accelerated, at both ends.
  const double way = share * share * share * (10 + share * (6 * share - 15));
  const double speed = length_s > 0 ? 30 * share * share * (1 - share) * (1 - share) / length_s : 0;
  return {.position = from.position + way * (to.position - from.position),
          .velocity = speed * (to.position - from.position),
          .rotation = from.rotation + way * (to.rotation - from.rotation),
          .grip = from.grip};
}

}  // namespace forcebound::server
