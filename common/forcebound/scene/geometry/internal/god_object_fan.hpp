#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forcebound/scene/geometry/facets.hpp"
#include "forcebound/scene/geometry/internal/god_object_search.hpp"

namespace forcebound::scene::god_object {

/// The triangles about a point of the surface, and the steps over them that lead nearer to the goal, the fastest first.
class Fan {
 public:
  struct Step {
    Point way;
    double rate = 0;  // decrease of the distance to the goal per length of way
    std::uint32_t place = 0;
  };

  Fan(const Facets& facets, Search& search, const Point& proxy, const Point& goal) noexcept;

  [[nodiscard]] std::span<const Step> steps() const noexcept { return std::span(steps_).first(step_count_); }

  /// The triangles about the point that connect to the step's triangle from edge to edge, if all of them share one
  /// vertex and do not pass through each other: then none of them blocks a step on the god object's side, whatever
  /// their planes do. Else nullopt.
  [[nodiscard]] std::optional<std::span<const std::uint32_t>> around(std::size_t step) noexcept;

 private:
  static constexpr std::size_t kMost = 64;
  static constexpr std::size_t kPairsOf = 16;  // for more triangles, pairs are not tested
  static constexpr std::size_t kStepsMost = 8;

  /// A triangle seen from the vertex: an arc of a great circle.
  struct Arc {
    std::uint32_t from;
    std::uint32_t to;
  };

  [[nodiscard]] const TriangleMesh& mesh() const noexcept { return facets_.bvh().mesh(); }
  [[nodiscard]] std::uint32_t triangle(std::uint32_t place) const noexcept { return facets_.bvh().order()[place]; }

  [[nodiscard]] Point arm(std::uint32_t vertex, std::uint32_t end) const noexcept {
    return mesh().vertices_m()[end] - mesh().vertices_m()[vertex];
  }
  [[nodiscard]] std::span<const std::uint32_t> members() const noexcept { return std::span(about_).first(members_); }

  void gather_members(std::uint32_t first) noexcept;

  [[nodiscard]] bool is_simple() const noexcept;

  [[nodiscard]] bool is_simple_about(std::uint32_t vertex) const noexcept;

  /// Whether the triangles go around the vertex once and all face one direction. Most vertices are so.
  [[nodiscard]] bool winds_once(std::uint32_t vertex, std::span<const Arc> arcs) const noexcept;

  [[nodiscard]] bool cross(std::uint32_t vertex, const Arc& one, const Arc& other) const noexcept;

  void insert(Step step) noexcept;

  const Facets& facets_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, kMost> about_;
  std::size_t members_ = 0;  // the first of `about_`, which connect from edge to edge
  bool is_simple_ = false;
  std::size_t step_count_ = 0;
  std::array<Step, kStepsMost> steps_;
};

}  // namespace forcebound::scene::god_object
