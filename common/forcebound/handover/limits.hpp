#pragma once

#include <cstddef>
#include <cstdint>

namespace forcebound::handover {

/// How much a client takes from a server; more is refused before any memory is spent on it.
struct Limits {
  std::size_t manifest_bytes = std::size_t{1} << 20U;  ///< read as a whole, before counts
  std::size_t pieces = std::size_t{1} << 17U;
  std::size_t parts = 1024;
  std::size_t effects_of_a_part = 32;
  std::size_t triangles = 1'000'000;                ///< of all meshes together
  std::size_t heights = std::size_t{1} << 22U;      ///< of all height fields together
  std::size_t shape_bytes = std::size_t{1} << 30U;  ///< memory of all shapes made of geometries
  std::size_t triangles_in_one_place = 4096;        ///< of a mesh; a lathe's pole has as many
  double tick_ns = 300e3;                           ///< predicted work of a tick: more would make it late
  std::uint64_t nodes_of_a_build = 1'000'000'000;   ///< of the trees of all meshes, visited for distance fields

  /// Of the trees of all meshes, that one tick visits. What a tick takes is predicted where meshes are as usual; a mesh
  /// may be made so that all of its triangles are equally near.
  [[nodiscard]] std::uint64_t nodes_of_a_tick() const noexcept {
    constexpr double kNode_ns = 20;
    return static_cast<std::uint64_t>(tick_ns / kNode_ns);
  }

  /// For a device of that period: three tenths of a tick are the scene's.
  [[nodiscard]] static Limits of_period(double period_s) noexcept {
    Limits limits;
    limits.tick_ns = 0.3e9 * period_s;
    return limits;
  }
};

}  // namespace forcebound::handover
