#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "forcebound/scene/geometry/facets.hpp"
#include "forcebound/scene/geometry/internal/skins.hpp"

namespace forcebound::scene::god_object {

/// The planes, at most three, that hold the god object where it is, and its way to the point nearest to the goal in
/// their common outside. When the way meets another plane, the next optimum lies on that plane: its candidates are the
/// plane itself, its creases with each of the others, and standing still.
class Constraints {
 public:
  explicit Constraints(const Facets& facets) noexcept : facets_(facets), skin_m_(facets.skin_m()) {}

  void clear() noexcept {
    count_ = 0;
    least_ = 0;
  }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// The way from the god object's position, with one more plane. `wanted` leads to the goal.
  [[nodiscard]] Point add(const Facets::Constraint& plane, const Point& wanted) noexcept {
    const Point single = wanted - plane.normal * (plane.normal.dot(wanted) + plane.height_m);
    // Each choice ends farther from the goal than the one before, so that no choice repeats.
    if ((single - wanted).squaredNorm() > least_ && fits(single, count_)) {
      return keep(single, wanted, plane, nullptr);
    }
    Point best = Point::Zero();
    const Facets::Constraint* other = nullptr;
    for (std::size_t i = 0; i < count_; ++i) {
      Point way;
      if (!along_crease(plane, held_[i], wanted, way) || !fits(way, i)) continue;
      if (other != nullptr && (way - wanted).squaredNorm() >= (best - wanted).squaredNorm()) continue;
      best = way;
      other = &held_[i];
    }
    if (other != nullptr) return keep(best, wanted, plane, other);
    held_[count_++] = plane;
    return Point::Zero();
  }

  /// Whether the god object, having moved to `p`, still touches the triangles of all planes.
  [[nodiscard]] bool follow(const Point& p) noexcept {
    bool on_all = true;
    for (Facets::Constraint& plane : std::span(held_).first(count_)) {
      plane = facets_.seen_from(p, plane);
      on_all = on_all && std::abs(plane.height_m) <= kFitSkins * skin_m_ && is_on(*plane.facet, p);
    }
    return on_all;
  }

  /// Whether the planes describe the whole surface about `p`: none of their triangles ends there, except at another one
  /// that rises from it. Then the free space is convex, and the nearest point on the planes is the nearest of all.
  [[nodiscard]] bool are_all_about(const Point& p) const noexcept {
    return std::ranges::all_of(held(), [&](const Facets::Constraint& plane) {
      for (std::size_t side = 0; side < 3; ++side) {
        const Facets::Plane& end = plane.facet->edges[side].plane;
        if (end.normal.dot(p) - end.offset < -kRisingEdgeSkins * skin_m_) continue;
        const std::uint32_t beyond = facets_.neighbour(*plane.facet, side);
        const auto rises = [&](const Facets::Constraint& other) {
          return facets_.triangle_of(*other.facet) == beyond && other.normal.dot(end.normal) < 0;
        };
        if (std::ranges::none_of(held(), rises)) return false;
      }
      return true;
    });
  }

 private:
  static constexpr double kFitSkins = 4;
  // Planes at a smaller angle have no crease: over the whole mesh they differ by less than the skin.
  static constexpr double kSameDirection = 0x1p-46;

  Point keep(const Point& way, const Point& wanted, const Facets::Constraint& plane,
             const Facets::Constraint* other) noexcept {
    const Facets::Constraint second = other == nullptr ? Facets::Constraint{} : *other;
    count_ = 0;
    held_[count_++] = plane;
    if (other != nullptr) held_[count_++] = second;
    least_ = (way - wanted).squaredNorm();
    return way;
  }

  [[nodiscard]] bool fits(const Point& way, std::size_t except) const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (i != except && held_[i].normal.dot(way) + held_[i].height_m < -kFitSkins * skin_m_) return false;
    }
    return true;
  }

  [[nodiscard]] static bool along_crease(const Facets::Constraint& one, const Facets::Constraint& other,
                                         const Point& wanted, Point& way) noexcept {
    Point crease = one.normal.cross(other.normal);
    const double sine = crease.norm();
    if (!(sine > kSameDirection)) return false;
    crease /= sine;
    // At a small angle, rounding turns the way out of the first plane; project it back.
    crease = (crease - one.normal * one.normal.dot(crease)).normalized();
    way = crease * crease.dot(wanted) - one.normal * one.height_m;
    way -= other.normal * std::min(0.0, other.normal.dot(way) + other.height_m);
    return true;
  }

  [[nodiscard]] std::span<const Facets::Constraint> held() const noexcept { return std::span(held_).first(count_); }

  [[nodiscard]] static bool is_on(const Facets::Facet& facet, const Point& p) noexcept {
    return std::ranges::all_of(facet.edges, [&](const Facets::Edge& edge) {
      return edge.plane.normal.dot(p) - edge.plane.offset <= edge.beyond_m;
    });
  }

  const Facets& facets_;
  double skin_m_;
  double least_ = 0;  // squared distance from the end of the way to the goal
  std::size_t count_ = 0;
  std::array<Facets::Constraint, 3> held_;  // the third only while standing still
};

}  // namespace forcebound::scene::god_object
