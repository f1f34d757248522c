#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "forcebound/scene/geometry/geometry_error.hpp"
#include "forcebound/scene/geometry/mesh_placement.hpp"
#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// The indices of a triangle's vertices, anticlockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

using Bounds = Eigen::AlignedBox3d;

/// Facts of a mesh, and repairs made to it. Edges are counted before slivers are dropped: a triangle without an area
/// opens no surface.
struct MeshReport {
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t welded_vertices = 0;        ///< equal to another one, and merged with it
  std::size_t unreferenced_vertices = 0;  ///< of no triangle that was kept, dropped
  std::size_t slivers = 0;                ///< triangles thinner than kSliver of the mesh, dropped
  std::size_t duplicate_triangles = 0;    ///< the same corners the same way round as another one, dropped
  std::size_t open_edges = 0;             ///< of one triangle only
  std::size_t non_manifold_edges = 0;     ///< of three triangles or more
  std::size_t inconsistent_edges = 0;     ///< of two triangles that disagree about which side is outside
  double volume_m3 = 0;                   ///< if closed; < 0: inside out, as a cavity

  /// Whether the surface encloses a volume.
  [[nodiscard]] bool closed() const noexcept {
    return open_edges == 0 && non_manifold_edges == 0 && inconsistent_edges == 0;
  }
};

/// In one line: "5856 triangles, 2930 vertices, closed; dropped 3 slivers".
[[nodiscard]] std::string to_text(const MeshReport& report);

/// Where a mesh's own frame lies, and what of the whole mesh its parts need to know.
struct MeshFrame {
  Point origin_m = Point::Zero();  ///< in the scene
  Bounds box_m{};                  ///< of the whole mesh, in its own frame
  MeshReport report{};             ///< of the whole mesh
};

/// A surface of triangles. Immutable.
///
/// Vertices are kept in the mesh's own frame, whose axes are the scene's and whose origin is the middle of the mesh's
/// bounding box: computations there lose no digits, whatever the mesh's position and size.
class TriangleMesh {
 public:
  /// The least height of a triangle, as a share of the mesh's size. The normal of a thinner one would be rounding
  /// error; the tolerances of contact bridge the gap that it leaves.
  static constexpr double kSliver = 0x1p-38;

  /// Where a triangle has no neighbour.
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// @param name for errors: the file.
  /// @throws GeometryError if a coordinate is not finite, a corner is not among the vertices, the placement is not
  /// finite with scale > 0, or no triangle is left.
  TriangleMesh(std::string name, const std::vector<Point>& vertices, const std::vector<Triangle>& triangles,
               const MeshPlacement& placement = {});

  /// The whole or a part of a mesh whose vertices are given in its own frame: made of all of another mesh's vertices
  /// and triangles with its frame, it is that mesh again, to the bit. A part is as large as the whole for all that
  /// counts in shares of the size, and reports what the whole is like.
  /// @throws GeometryError as above, and if the box does not hold the vertices
  TriangleMesh(std::string name, const std::vector<Point>& vertices_m, const std::vector<Triangle>& triangles,
               const MeshFrame& frame);

  [[nodiscard]] MeshFrame frame() const { return {.origin_m = origin_m_, .box_m = box_m_, .report = report_}; }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const MeshReport& report() const noexcept { return report_; }

  /// The origin of the mesh's own frame in the scene.
  [[nodiscard]] const Point& origin_m() const noexcept { return origin_m_; }
  /// Half the diagonal of the bounding box.
  [[nodiscard]] double size_m() const noexcept { return size_m_; }
  /// The bounding box, in the mesh's own frame.
  [[nodiscard]] const Bounds& box_m() const noexcept { return box_m_; }

  [[nodiscard]] const std::vector<Point>& vertices_m() const noexcept { return vertices_m_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const noexcept { return triangles_; }
  /// One of length 1 for each triangle, to the outside.
  [[nodiscard]] const std::vector<Point>& normals() const noexcept { return normals_; }
  /// The triangles beyond the edges from corner 0 to 1, 1 to 2 and 2 to 0; kNone where the edge does not have two
  /// triangles that agree.
  [[nodiscard]] const std::vector<Triangle>& neighbours() const noexcept { return neighbours_; }

  [[nodiscard]] const Point& corner_m(std::size_t triangle, std::size_t corner) const {
    return vertices_m_[triangles_[triangle][corner]];
  }

  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  void check_corners(const std::vector<Point>& vertices) const;
  void check_size() const;
  void mend();
  void place(const std::vector<Point>& as_read, const MeshPlacement& placement);
  void weld();
  void drop_duplicates();
  void count_edges();
  void drop_slivers();
  void drop_unreferenced();
  void find_normals();

  std::string name_;
  MeshReport report_;
  Point origin_m_ = Point::Zero();
  double size_m_ = 0;
  Bounds box_m_;
  std::vector<Point> vertices_m_;
  std::vector<Triangle> triangles_;
  std::vector<Point> normals_;
  std::vector<Triangle> neighbours_;
};

}  // namespace forcebound::scene
