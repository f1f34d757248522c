#include "forcebound/scene/geometry/internal/god_object_fan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcebound::scene::god_object {

Fan::Fan(const Facets& facets, Search& search, const Point& proxy, const Point& goal) noexcept : facets_(facets) {
  const double reach_m = kAboutSkins * facets.skin_m();
  search.for_each_about({proxy.array() - reach_m, proxy.array() + reach_m}, [&](std::uint32_t place) {
    const Facets::Facet& facet = facets[place];
    const bool near = std::abs(facet.plane.normal.dot(proxy) - facet.plane.offset) <= reach_m;
    if (near && Facets::is_within(facet, proxy, reach_m) && count_ < kMost) about_[count_++] = place;
  });
  for (const std::uint32_t place : std::span(about_).first(count_)) {
    const NearestOnTriangle best = facets.bvh().nearest_on(facets.bvh().order()[place], goal);
    Step step{best.point_m - proxy, 0, place};
    // Keep the height above the triangle.
    const Point& normal = facets[place].plane.normal;
    step.way -= normal * normal.dot(step.way);
    const double length_m = step.way.norm();
    if (length_m <= 2 * reach_m) continue;
    step.rate = (goal - proxy).dot(step.way) / length_m;
    if (step.rate > 0) insert(step);
  }
}

std::optional<std::span<const std::uint32_t>> Fan::around(std::size_t step) noexcept {
  if (std::ranges::find(members(), steps_[step].place) == members().end()) {
    gather_members(steps_[step].place);
    is_simple_ = is_simple();
  }
  return is_simple_ ? std::optional(members()) : std::nullopt;
}

bool Fan::is_simple() const noexcept {
  if (members_ <= 2) return true;
  const Triangle& first = mesh().triangles()[triangle(about_[0])];
  return std::ranges::any_of(first, [&](std::uint32_t vertex) { return is_simple_about(vertex); });
}

bool Fan::is_simple_about(std::uint32_t vertex) const noexcept {
  std::array<Arc, kMost> all;
  for (std::size_t i = 0; i < members_; ++i) {
    const Triangle& t = mesh().triangles()[triangle(about_[i])];
    const auto corner = static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
    if (corner == 3) return false;
    all[i] = {t[(corner + 1) % 3], t[(corner + 2) % 3]};
  }
  const std::span<const Arc> arcs = std::span(all).first(members_);
  if (winds_once(vertex, arcs)) return true;
  if (members_ > kPairsOf) return false;
  for (std::size_t i = 0; i < members_; ++i) {
    if (std::ranges::any_of(arcs.first(i), [&](const Arc& other) { return cross(vertex, arcs[i], other); })) {
      return false;
    }
  }
  return true;
}

bool Fan::winds_once(std::uint32_t vertex, std::span<const Arc> arcs) const noexcept {
  const auto normal = [&](std::uint32_t place) -> const Point& { return mesh().normals()[triangle(place)]; };
  Point up = Point::Zero();
  for (const std::uint32_t place : members()) up += normal(place);
  if (!std::ranges::all_of(members(), [&](std::uint32_t place) { return normal(place).dot(up) > 0; })) return false;
  const bool closed = std::ranges::all_of(arcs, [&](const Arc& arc) {
    return std::ranges::any_of(arcs, [&](const Arc& next) { return next.from == arc.to; });
  });
  const Point some = arm(vertex, arcs[0].from).normalized() + arm(vertex, arcs[0].to).normalized();
  return closed && std::ranges::count_if(arcs, [&](const Arc& arc) {
                     return up.dot(arm(vertex, arc.from).cross(some)) >= 0 &&
                            up.dot(some.cross(arm(vertex, arc.to))) > 0;
                   }) == 1;
}

bool Fan::cross(std::uint32_t vertex, const Arc& one, const Arc& other) const noexcept {
  if (one.from == other.to || one.to == other.from) return false;
  const Point a = arm(vertex, one.from);
  const Point b = arm(vertex, one.to);
  const Point c = arm(vertex, other.from);
  const Point d = arm(vertex, other.to);
  const Point ab = a.cross(b);
  const Point cd = c.cross(d);
  const std::array<double, 4> off{cd.dot(a), cd.dot(b), ab.dot(c), ab.dot(d)};
  if (off[0] * off[1] > 0 || off[2] * off[3] > 0) return false;
  // Whether the points where each meets the other's plane lie in the same direction.
  return (std::abs(off[1]) * a + std::abs(off[0]) * b).dot(std::abs(off[3]) * c + std::abs(off[2]) * d) >= 0;
}

void Fan::gather_members(std::uint32_t first) noexcept {
  const auto end = about_.begin() + static_cast<std::ptrdiff_t>(count_);
  auto last = std::partition(about_.begin(), end, [&](std::uint32_t place) { return place == first; });
  for (auto member = about_.begin(); member != last; ++member) {
    const Triangle& beyond = mesh().neighbours()[triangle(*member)];
    last = std::partition(
        last, end, [&](std::uint32_t place) { return std::ranges::find(beyond, triangle(place)) != beyond.end(); });
  }
  members_ = static_cast<std::size_t>(last - about_.begin());
}

void Fan::insert(Step step) noexcept {
  for (Step& other : std::span(steps_).first(step_count_)) {
    if (step.rate > other.rate) std::swap(step, other);
  }
  if (step_count_ < kStepsMost) steps_[step_count_++] = step;
}

}  // namespace forcebound::scene::god_object
