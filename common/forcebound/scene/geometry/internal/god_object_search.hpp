#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "forcebound/scene/geometry/facets.hpp"
#include "forcebound/scene/geometry/internal/skins.hpp"

namespace forcebound::scene::god_object {

/// Finds obstacles. The triangles gathered about one way serve all ways inside the same box, so that most motions
/// search the tree once or twice.
class Search {
 public:
  /// @param queries_most in the tree
  Search(const Facets& facets, int queries_most) noexcept : facets_(facets), queries_most_(queries_most) {}

  /// Whether one more turn, of a way and steps around, might exceed the limit of searches.
  [[nodiscard]] bool is_over() const noexcept { return searches_ > queries_most_ - kMostPerTurn; }

  void gather_about(const Segment& path) noexcept {
    if (box_.contains(Point(path.from_m + path.way_m))) return;
    const Point room = Point::Constant(kRoom * path.way_m.norm() + 2 * kAboutSkins * facets_.skin_m());
    Bounds box(path.from_m);
    box.extend(Point(path.from_m + path.way_m));
    box_ = {box.min() - room, box.max() + room};
    ++searches_;
    const auto count = facets_.bvh().gather(box_, gathered_);
    count_ = count.value_or(0);
    if (!count) box_.setEmpty();
  }

  /// Calls visit(place) for each triangle whose box meets the box, and perhaps for some more.
  template <class Visit>
  void for_each_about(const Bounds& box, Visit visit) noexcept {
    if (box_.contains(box)) {
      std::ranges::for_each(gathered(), visit);
    } else {
      ++searches_;
      facets_.bvh().for_each_about(box, visit);
    }
  }

  /// The first obstacle that is not among `without`. A path that would change sides through one of those is blocked
  /// from its start.
  [[nodiscard]] bool first_obstacle(const Segment& path, Facets::Obstacle& found,
                                    std::span<const std::uint32_t> without = {}) noexcept {
    bool blocked = false;
    double until = 1;
    const auto visit = [&](std::uint32_t place, double share) {
      const Facets::Facet& facet = facets_[place];
      if (!without.empty() && std::ranges::find(without, place) != without.end()) {
        if (!facets_.changes_sides(facet, path, share)) return share;
        found.share = 0;
      } else if (!facets_.is_in_the_way(facet, path, share, found)) {
        return share;
      }
      blocked = true;
      return found.share;
    };
    ++searches_;
    if (box_.contains(path.from_m)) {
      for (const std::uint32_t place : gathered()) until = visit(place, until);
      if (box_.contains(Point(path.from_m + until * path.way_m))) return blocked;
    }
    facets_.bvh().for_each_along(path, until, visit);
    return blocked;
  }

 private:
  static constexpr std::size_t kMost = 64;
  static constexpr double kRoom = 0.5;  // of the way
  static constexpr int kMostPerTurn = 12;

  [[nodiscard]] std::span<const std::uint32_t> gathered() const noexcept { return std::span(gathered_).first(count_); }

  const Facets& facets_;
  int queries_most_;
  int searches_ = 0;
  Bounds box_;  // empty: nothing is gathered
  std::size_t count_ = 0;
  std::array<std::uint32_t, kMost> gathered_;
};

}  // namespace forcebound::scene::god_object
