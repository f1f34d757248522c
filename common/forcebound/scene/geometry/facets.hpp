#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/scene/geometry/segment.hpp"

namespace forcebound::scene {

/// The triangles of a mesh as a GodObject meets them: each holds it over itself and a little beyond its edges, so that
/// rounding opens no gap. In the mesh's own frame; the tolerances are those that GodObject describes.
///
/// Real time: noexcept, no allocation, but for the constructor.
class Facets {
 public:
  struct Plane {
    Point normal;
    double offset = 0;  // normal . x of its points
  };

  /// The plane upright on a triangle through one of its edges, normal outwards.
  struct Edge {
    Plane plane;
    double beyond_m = 0;  // how far past the edge the triangle still holds
    double below_m = 0;   // a path that leaves over the edge no deeper than this has not met the triangle
  };

  struct Facet {
    Plane plane;
    std::array<Edge, 3> edges;
  };

  /// The plane of a facet in the way, and the god object's height above it.
  struct Constraint {
    Point normal;
    double height_m;
    const Facet* facet;
  };

  struct Obstacle {
    Constraint constraint;
    double share = 0;  // of the way to it
  };

  /// @param two_sided contact from behind the triangles as well
  Facets(Bvh tree, bool two_sided);

  [[nodiscard]] const Bvh& bvh() const noexcept { return bvh_; }
  [[nodiscard]] double skin_m() const noexcept { return skin_m_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return bvh_.memory_bytes() + facets_.size() * sizeof(Facet) + bvh_.mesh().memory_bytes();
  }

  /// @param place in the order of the tree
  [[nodiscard]] const Facet& operator[](std::uint32_t place) const noexcept { return facets_[place]; }
  [[nodiscard]] std::uint32_t triangle_of(const Facet& facet) const noexcept {
    return bvh_.order()[static_cast<std::size_t>(&facet - facets_.data())];
  }
  [[nodiscard]] std::uint32_t neighbour(const Facet& facet, std::size_t side) const noexcept {
    return bvh_.mesh().neighbours()[triangle_of(facet)][side];
  }

  /// The same plane as it is seen from `p`.
  [[nodiscard]] Constraint seen_from(const Point& p, const Constraint& plane) const noexcept;
  [[nodiscard]] static bool is_within(const Facet& facet, const Point& p, double beyond_m) noexcept;
  [[nodiscard]] bool is_in_the_way(const Facet& facet, const Segment& path, double until,
                                   Obstacle& found) const noexcept;
  /// Whether the path goes through the triangle, where both sides are felt.
  [[nodiscard]] bool changes_sides(const Facet& facet, const Segment& path, double until) const noexcept;

 private:
  /// The part of a path that lies over a triangle.
  struct Passage {
    double enter = 0;  // shares of the path
    double leave = 1;
    double below_m = 0;  // of the edge over which it leaves

    /// False if there is none.
    [[nodiscard]] bool enter_over(const Facet& facet, const Segment& path) noexcept;
  };

  [[nodiscard]] Facet facet_of(std::uint32_t triangle) const;
  [[nodiscard]] Edge edge_of(std::uint32_t triangle, std::size_t side) const;
  /// Whether that part of the path lies where the planes of two edges at a sharp corner, moved outwards, reach far.
  [[nodiscard]] bool is_past_a_corner(const Facet& facet, const Segment& path, const Passage& over) const noexcept;

  Bvh bvh_;
  std::vector<Facet> facets_;  // in the order of the tree
  double skin_m_;
  double clearance_m_;  // kept from the surface, so that the god object's side is known
  bool two_sided_;
};

}  // namespace forcebound::scene
