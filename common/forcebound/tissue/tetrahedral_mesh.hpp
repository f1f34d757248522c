#pragma once

#include <array>
#include <string>
#include <vector>

#include "forcebound/scene/geometry/mesh_placement.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/tissue/gmsh_file.hpp"

namespace forcebound::tissue {

/// A body of tetrahedra and its surface, checked for use with an elastic law. They may have a node in the middle of
/// each edge beside those at their corners, or be parts of boxes: see ElasticElements.
///
/// Every tetrahedron has a positive volume: one whose nodes are listed the other way round is turned and counted. Nodes
/// that no tetrahedron uses are left out and counted. Triangles of the surface are counter-clockwise seen from outside.
///
/// Immutable.
class TetrahedralMesh {
 public:
  using Tetrahedron = std::array<int, 4>;
  using Triangle = std::array<int, 3>;
  using Middles = std::array<int, 6>;
  using Box = std::array<int, 8>;

  /// Corners of a tetrahedron that its edges join.
  static constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

  /// Thinnest tetrahedron accepted: six times its volume over its longest edge's cube.
  static constexpr double kFlat = 1e-6;

  /// Most by which a corner of a box may be off its place, as a share of the box's shortest edge.
  static constexpr double kOffMost = 1e-6;

  /// @param placement where the soup's nodes lie in the scene
  /// @throws std::runtime_error `FILE:LINE: what`, for a tetrahedron that is flat, for nodes that are not finite, for
  /// more than two tetrahedra at one triangle, for two that overlap since both lie on the same side of it, and for
  /// boxes that are not alike but for their place, or not right-angled.
  explicit TetrahedralMesh(const TetrahedralSoup& soup, const scene::MeshPlacement& placement = {});

  /// The same with a node in the middle of each edge, and each triangle cut into four by those. Not of boxes.
  [[nodiscard]] TetrahedralMesh with_middles() const;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::vector<scene::Point>& nodes_m() const noexcept { return nodes_m_; }
  [[nodiscard]] const std::vector<Tetrahedron>& tetrahedra() const noexcept { return tetrahedra_; }
  [[nodiscard]] const std::vector<double>& volumes_m3() const noexcept { return volumes_m3_; }

  /// Nodes in the middle of each tetrahedron's kEdges; none where they have no such nodes.
  [[nodiscard]] const std::vector<Middles>& middles() const noexcept { return middles_; }
  /// As in the soup: right-angled, all alike but for their place.
  [[nodiscard]] const std::vector<Box>& boxes() const noexcept { return boxes_; }
  /// How many: boxes, or else tetrahedra.
  [[nodiscard]] std::size_t elements() const noexcept { return boxes_.empty() ? tetrahedra_.size() : boxes_.size(); }
  [[nodiscard]] const std::vector<Triangle>& triangles() const noexcept { return triangles_; }

  /// The nodes of the surface, each once, in the order of their indices.
  [[nodiscard]] const std::vector<int>& surface_nodes() const noexcept { return surface_nodes_; }

  [[nodiscard]] double volume_m3() const noexcept;
  [[nodiscard]] double mean_edge_m() const noexcept;  ///< of the surface

  /// Sets of tetrahedra that share no node with each other: what is one body has one.
  [[nodiscard]] int pieces() const noexcept { return pieces_; }
  /// Nodes exactly where one before them is: two pieces that touch so are not joined.
  [[nodiscard]] int coincident_nodes() const noexcept { return coincident_nodes_; }

 private:
  void add_nodes(const TetrahedralSoup& soup, const scene::MeshPlacement& placement);
  void add_tetrahedra(const TetrahedralSoup& soup, const std::vector<int>& index);
  void add_boxes(const TetrahedralSoup& soup, const std::vector<int>& index);
  void find_surface(const TetrahedralSoup& soup);
  void find_surface_nodes();
  void count_pieces();

  std::string name_;
  std::vector<scene::Point> nodes_m_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<double> volumes_m3_;
  std::vector<Middles> middles_;
  std::vector<Box> boxes_;
  std::vector<Triangle> triangles_;
  std::vector<int> surface_nodes_;
  int pieces_ = 0;
  int coincident_nodes_ = 0;
};

/// Words for a mesh in several pieces, such as ", in 2 pieces, which are not joined where 16 nodes lie on others";
/// empty: it is in one.
[[nodiscard]] std::string pieces_in_words(const TetrahedralMesh& mesh);

/// The nodes on or below the plane through a point; `normal` (any length but zero) points up.
[[nodiscard]] std::vector<int> nodes_below(const TetrahedralMesh& mesh, const scene::Point& through_m,
                                           const scene::Point& normal);

/// The nodes in or on a block along the axes.
[[nodiscard]] std::vector<int> nodes_in_box(const TetrahedralMesh& mesh, const scene::Point& center_m,
                                            const scene::Point& size_m);

}  // namespace forcebound::tissue
