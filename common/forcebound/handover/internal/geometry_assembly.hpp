#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/handover/coverage.hpp"
#include "forcebound/handover/limits.hpp"
#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"
#include "forcebound/v1/handover.pb.h"

/// Private to handover.
namespace forcebound::handover {

/// One mesh or grid of heights of a manifest, and the pieces of it that have arrived.
class GeometryAssembly {
 public:
  /// @param first number of its first piece
  /// @throws HandoverError if it contradicts itself
  GeometryAssembly(const v1::Geometry& geometry, std::size_t first);

  [[nodiscard]] std::size_t first() const noexcept { return first_; }
  /// Its lists of pieces included, which come first.
  [[nodiscard]] std::size_t pieces() const noexcept { return lists_.size() + contents_.size(); }
  /// Without lists.
  [[nodiscard]] std::size_t here() const noexcept { return here_; }
  [[nodiscard]] bool whole() const noexcept { return here_ == contents_.size(); }

  /// Whether the hash of the piece is known: that of a list always is.
  [[nodiscard]] bool knows_hash_of(std::size_t number) const noexcept;

  /// Numbers of the pieces that a list names, from `first` to before `end`; none if it is no list.
  struct Listed {
    std::size_t first = 0;
    std::size_t end = 0;
  };
  [[nodiscard]] Listed listed_by(std::size_t number) const noexcept;

  /// Number of the geometry of which it is a coarse level, 1 and up; 0: of none.
  [[nodiscard]] std::size_t coarse_of() const noexcept { return geometry_.coarse_of(); }
  [[nodiscard]] double error_m() const noexcept { return geometry_.error_m(); }

  /// Of a piece whose hash is known. @throws HandoverError if it is not the piece of that number
  void add(std::size_t number, std::span<const std::byte> bytes);

  struct Made {
    scene::ShapeGeometry geometry{};
    std::size_t in_fullest_place = 0;  ///< triangles of a mesh, in about the fullest place
  };

  /// A geometry of the pieces that have arrived.
  /// @throws HandoverError, scene::GeometryError
  [[nodiscard]] Made made(const Limits& limits) const;

  [[nodiscard]] Coverage coverage() const;
  [[nodiscard]] double known_within_m(const Point& point_m) const;

  void append_content(std::vector<std::byte>& to) const;

 private:
  static constexpr std::uint32_t kUnknown = 0xFFFFFFFF;

  [[nodiscard]] bool is_mesh() const noexcept { return geometry_.triangles() > 0; }
  [[nodiscard]] Eigen::AlignedBox3d whole_box_m() const;
  [[nodiscard]] Eigen::AlignedBox3d box_m(std::size_t piece) const;
  [[nodiscard]] Eigen::AlignedBox3d mesh_box_m(std::string_view boxes, std::size_t place) const;  // in its own frame
  template <class Use>
  void for_each_missing_m(Use use) const;
  void add_list(std::size_t number, std::span<const std::byte> bytes);
  void add_triangles(const v1::MeshPiece& piece, std::size_t number_of_piece);
  void add_heights(const v1::HeightPiece& piece, std::size_t number);
  [[nodiscard]] std::shared_ptr<const scene::TriangleMesh> made_mesh() const;

  v1::Geometry geometry_;
  std::size_t first_;
  std::size_t here_ = 0;
  std::vector<std::string> lists_;     // contents; empty: not there
  std::string hashes_;                 // of the pieces; zeros: their list is not there
  std::string boxes_;                  // likewise
  std::vector<std::string> contents_;  // of the pieces; empty: not there
  scene::MeshFrame frame_{};
  std::vector<Point> vertices_m_;           // not a number: not there
  std::vector<scene::Triangle> triangles_;  // kUnknown: not there
  std::vector<double> heights_m_;           // zero: not there
};

}  // namespace forcebound::handover
