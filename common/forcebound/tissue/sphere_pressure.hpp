#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "forcebound/tissue/deformed_surface.hpp"

namespace forcebound::tissue {

/// Resistance [N/m] of a surface's triangles under spheres to motions of their corners, nine coordinates each.
struct PressedTriangles {
  using Resistance = Eigen::Matrix<double, 9, 9>;

  std::vector<Resistance> resistance;  ///< of each triangle of the surface; zero unless it is in `touched`
  std::vector<int> touched;            ///< room for all
  std::size_t count = 0;               ///< of those in `touched`

  PressedTriangles() = default;
  explicit PressedTriangles(std::size_t triangles) : resistance(triangles, Resistance::Zero()), touched(triangles) {}

  void clear() noexcept;

  /// In columns, for the changes of each corner, the same as DeformedSurface::corners_m.
  void add(int triangle, const Resistance& more) noexcept;

  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return resistance.size() * (sizeof(Resistance) + sizeof(int));
  }
};

/// A sphere that presses on a surface by a pressure that grows with depth, at places spread over its triangles: the
/// energy of a skin over the sphere, half its radius R thick, of stiffness k per area [Pa/m],
///
///     E(X, c) = sum over places q of  a_q k/2 d^2 / (1 - d/D),   d = max(0, R - |x_q - c|),   D = R/2
///     pressure k d (1 - d/2D) / (1 - d/D)^2,   second derivative along d:  k / (1 - d/D)^3
///
/// with a_q the place's share of the area at rest. No place comes nearer to the centre than R/2, since that would take
/// infinite energy. The places are the centroids of a triangle's parts, a quarter of R across at most, so that the
/// force converges as triangles get smaller, and does not depend on where their corners are.
///
/// Real time: all but the constructor is noexcept, allocates nothing, and passes once over the triangles and the places
/// of those near the sphere. Immutable.
class SpherePressure {
 public:
  /// Limits on places on the surface, and on each edge of a triangle; more are refused.
  static constexpr int kPlacesMax = 200'000;
  static constexpr int kDivisionsMax = 64;

  /// @param name of the body, for messages. @throws std::runtime_error beginning with it, for a sphere too small beside
  /// the surface.
  SpherePressure(const TissueSurface& surface, double radius_m, double stiffness_Pa_per_m, const std::string& name);

  [[nodiscard]] double radius_m() const noexcept { return radius_m_; }
  [[nodiscard]] double stiffness_Pa_per_m() const noexcept { return stiffness_Pa_per_m_; }
  [[nodiscard]] double skin_m() const noexcept { return 0.5 * radius_m_; }
  [[nodiscard]] std::size_t places() const noexcept { return places_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return cuts_.size() * sizeof(Cut); }

  /// Infinite where a place is too near.
  [[nodiscard]] double energy_J(const DeformedSurface& surface, const scene::Point& center_m) const noexcept;

  void add_forces(const DeformedSurface& surface, const scene::Point& center_m,
                  Eigen::VectorXd& on_nodes_N) const noexcept;

  void add_resistance(const DeformedSurface& surface, const scene::Point& center_m,
                      PressedTriangles& pressed) const noexcept;

  struct Touch {
    scene::Point force_N = scene::Point::Zero();  ///< on the sphere
    int places = 0;                               ///< that push
    double deepest_m = 0;                         ///< d, of all
  };

  [[nodiscard]] Touch touch(const DeformedSurface& surface, const scene::Point& center_m) const noexcept;

  /// Depth of the sphere below the surface at rest along a direction, at the deepest of the places that push.
  /// @param normal unit
  [[nodiscard]] double depth_at_rest_m(const DeformedSurface& surface, const scene::Point& center_m,
                                       const scene::Point& normal) const noexcept;

  /// The share of the way from one centre to another that a sphere can go before a place would be much deeper in its
  /// skin: half of what is left of the skin, or three quarters of all of it.
  [[nodiscard]] double free_share(const DeformedSurface& surface, const scene::Point& from_m,
                                  const scene::Point& to_m) const noexcept;

 private:
  struct Cut {
    int divisions;   // of each edge
    double area_m2;  // of one place
  };

  template <typename Do>
  void for_each_near(const DeformedSurface& surface, const scene::Point& center_m, const Do& act) const noexcept;

  [[nodiscard]] double nearest_m(double away_m) const noexcept;

  double radius_m_;
  double stiffness_Pa_per_m_;
  std::size_t places_ = 0;
  std::vector<Cut> cuts_;  // of each triangle
};

}  // namespace forcebound::tissue
