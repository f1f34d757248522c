#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/tissue/tetrahedral_mesh.hpp"

namespace forcebound::tissue {

/// A place on a surface of triangles.
struct SurfacePlace {
  int triangle = 0;
  scene::Point weight = scene::Point::Zero();  ///< of the triangle's corners, >= 0, in sum 1
};

/// One place by each of the triangles that have it.
struct PlacesAround {
  /// More triangles around one node are not looked at.
  static constexpr int kMax = 24;

  std::array<SurfacePlace, kMax> place;
  int count = 0;
};

/// What contact asks of a surface at rest: which triangle lies beside which, where a way goes in, and which way is out.
///
/// Real time: all but the constructor is noexcept, allocates nothing and takes time at most proportional to the number
/// of triangles. Immutable.
class TissueSurface {
 public:
  using Triangle = TetrahedralMesh::Triangle;

  static constexpr int kNone = -1;

  /// @param triangles counter-clockwise from outside, by indices into `nodes_m`
  TissueSurface(std::vector<scene::Point> nodes_m, std::vector<Triangle> triangles);

  [[nodiscard]] const std::vector<scene::Point>& nodes_m() const noexcept { return nodes_m_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const noexcept { return triangles_; }
  [[nodiscard]] const scene::Point& corner_m(int triangle, int corner) const noexcept {
    return nodes_m_[index(triangles_[index(triangle)][index(corner)])];
  }
  [[nodiscard]] scene::Point at(const SurfacePlace& place) const noexcept;

  /// The triangle across the edge opposite to a corner, or kNone where the surface is not closed or branches.
  [[nodiscard]] int beyond(int triangle, int corner) const noexcept { return beyond_[index(triangle)][index(corner)]; }

  /// The place by each triangle that has it: one, two at an edge, and all around a corner.
  [[nodiscard]] PlacesAround places_around(const SurfacePlace& place) const noexcept;

  /// Of the triangles around a node the one of least index: the one to count it, where each is to count once.
  [[nodiscard]] int first_triangle(int node) const noexcept { return first_triangles_[index(node)]; }

  [[nodiscard]] double longest_edge_m() const noexcept;

  /// Unit, out of a node: the mean of the triangles around it by their angles there.
  [[nodiscard]] const scene::Point& node_normal(int node) const noexcept { return node_normals_[index(node)]; }

  /// Unit, between those of the nodes around.
  [[nodiscard]] scene::Point normal_at(const SurfacePlace& place) const noexcept;
  [[nodiscard]] scene::Point triangle_normal(int triangle) const noexcept;

  /// Where the way from one point to another first goes in from outside, if it does.
  [[nodiscard]] std::optional<SurfacePlace> entry(const scene::Point& from_m, const scene::Point& to_m) const noexcept;

  struct Nearest {
    SurfacePlace place;
    double height_m = 0;  ///< of the point over the plane of the place's triangle; < 0: it is inside
  };

  /// The place nearest to a point.
  [[nodiscard]] Nearest nearest(const scene::Point& point_m) const noexcept;

  /// Whether a box along the axes has nothing of the surface in it, by the box around all nodes.
  [[nodiscard]] bool is_clear_of(const scene::Point& low_m, const scene::Point& high_m) const noexcept {
    return (low_m.array() > high_m_.array()).any() || (high_m.array() < low_m_.array()).any();
  }

 private:
  [[nodiscard]] static std::size_t index(int number) noexcept { return static_cast<std::size_t>(number); }

  void find_neighbours();
  void find_normals();
  [[nodiscard]] SurfacePlace seen_from(const SurfacePlace& place, int triangle) const noexcept;
  void go_around(const SurfacePlace& start, int node, int out, PlacesAround& found) const noexcept;

  std::vector<scene::Point> nodes_m_;
  std::vector<Triangle> triangles_;
  std::vector<Triangle> beyond_;
  std::vector<int> first_triangles_;
  std::vector<scene::Point> node_normals_;
  scene::Point low_m_ = scene::Point::Zero();
  scene::Point high_m_ = scene::Point::Zero();
};

}  // namespace forcebound::tissue
