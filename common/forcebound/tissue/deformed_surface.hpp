#pragma once

#include <Eigen/Core>

#include "forcebound/tissue/tissue_surface.hpp"

namespace forcebound::tissue {

/// A probe's tie to a place of the surface.
struct SurfaceTie {
  SurfacePlace place;
  scene::Point probe_m = scene::Point::Zero();
  bool slides = false;                             ///< to where it is nearest to the probe; else the place stays
  bool pulls = false;                              ///< would pull, hence is left out: decided anew in each step
  scene::Point balanced_m = scene::Point::Zero();  ///< from the place to the probe when forces last balanced
};

/// A deformed surface, and the energy of ties of unit stiffness between it and probes.
///
/// A sliding tie resists only where it cannot slide. With the probe c, the triangle's corners X and their weights w, of
/// which D spans the changes that leave the place where it may be (inside the triangle, on the edge or in the corner
/// that it is at),
///
///     E(X) = min over w  1/2 |d|^2,   d = c - X w,   pushes corner a by w_a d
///     dX changes that push by  w_a dd + dw_a d,   dd = -dX w - X dw,   dw = D (D'X'X D)^-1 D' (dX'd - X'dX w)
///
/// Real time: noexcept, no allocation, bounded. Refers to both, which must outlive it.
class DeformedSurface {
 public:
  /// @param displacement_m three coordinates per node of the surface
  DeformedSurface(const TissueSurface& surface, const Eigen::VectorXd& displacement_m) noexcept
      : surface_(surface), displacement_m_(displacement_m) {}

  [[nodiscard]] const TissueSurface& at_rest() const noexcept { return surface_; }

  /// In columns.
  [[nodiscard]] Eigen::Matrix3d corners_m(int triangle) const noexcept;

  /// Three coordinates of each corner, in columns, of what all nodes have.
  [[nodiscard]] Eigen::Matrix3d corners_of(int triangle, const Eigen::VectorXd& all) const noexcept;

  /// Columns are added to what the corners have.
  void add_to_corners(int triangle, const Eigen::Matrix3d& more, Eigen::VectorXd& all) const noexcept;

  [[nodiscard]] scene::Point at(const SurfacePlace& place) const noexcept {
    return corners_m(place.triangle) * place.weight;
  }

  /// From the place to the probe.
  [[nodiscard]] scene::Point stretch_m(const SurfaceTie& tie) const noexcept { return tie.probe_m - at(tie.place); }

  /// Whether the probe is outside of the surface at its place.
  [[nodiscard]] bool pulls(const SurfaceTie& tie) const noexcept;

  struct Slid {
    SurfacePlace place;
    double square_m2 = 0;  ///< of the tie's length
  };

  /// If the tie slides, moves the place to the nearest one around, from triangle to triangle.
  [[nodiscard]] Slid slid(const SurfaceTie& tie) const noexcept;

  /// Adds the second derivative of the tie's energy [m^2] times small motions of all nodes, times a stiffness.
  void add_resistance(const SurfaceTie& tie, double stiffness_N_per_m, const Eigen::VectorXd& moved_m,
                      Eigen::VectorXd& force_N) const noexcept;

  /// Adds a force at a place, shared among the corners.
  void add_at(const SurfacePlace& place, const scene::Point& force_N, Eigen::VectorXd& all_N) const noexcept;

 private:
  /// Coordinate of a corner.
  [[nodiscard]] Eigen::Index first_of(int triangle, int corner) const noexcept;

  const TissueSurface& surface_;
  const Eigen::VectorXd& displacement_m_;
};

}  // namespace forcebound::tissue
