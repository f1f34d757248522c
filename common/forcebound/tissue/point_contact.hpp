#pragma once

#include "forcebound/tissue/linear_tissue.hpp"
#include "forcebound/tissue/tissue_probe.hpp"

namespace forcebound::tissue {

class OtherContacts;

/// TissueModel::step for a pointed probe: sticks to its place of entry, and slides to the place of least energy.
///
/// Real time: noexcept, no allocation, bounded.
class PointContact {
 public:
  /// @param others may be null
  /// @param shift_m displacement by others of the surface near the probe
  PointContact(const LinearTissue& tissue, const ProbeOptions& options, OtherContacts* others, double tolerance_m,
               const scene::Point& probe_m, const scene::Point& shift_m) noexcept
      : tissue_(tissue),
        surface_(tissue.surface()),
        others_(others),
        probe_m_(probe_m),
        shift_m_(shift_m),
        tolerance_m_(tolerance_m),
        iterations_max_(options.iterations_max),
        yield_m_per_N_(1 / options.contact_stiffness_N_per_m) {}

  /// @param last state of the last step; updated
  TissueResult step(TissueState& last) const noexcept;

 private:
  // The probe stuck at a place: elastic energy, force, and stiffness there.
  struct Stuck {
    SurfacePlace place;
    scene::Point pushed_N = scene::Point::Zero();  // on the tissue
    double energy_J = 0;
    Eigen::Matrix3d stiffness_N_per_m = Eigen::Matrix3d::Zero();
  };

  struct Move {
    Stuck to;
    double length_m = 0;
  };

  [[nodiscard]] scene::Point moved_from(const SurfacePlace& place) const noexcept;
  void load_others(const Stuck& here) const noexcept;
  [[nodiscard]] Stuck stick(const SurfacePlace& place) const noexcept;
  [[nodiscard]] Move best_move(const Stuck& here) const noexcept;
  void try_triangle(const Stuck& here, const SurfacePlace& place, Move& best) const noexcept;
  void try_along(const Stuck& here, const SurfacePlace& place, const scene::Point& change, Move& best) const noexcept;
  [[nodiscard]] Eigen::Matrix3d deformed_corners(const Stuck& here, int triangle) const noexcept;
  [[nodiscard]] bool pulls(const Stuck& here) const noexcept;

  const LinearTissue& tissue_;
  const TissueSurface& surface_;
  OtherContacts* others_;
  scene::Point probe_m_;
  scene::Point shift_m_;
  double tolerance_m_;
  int iterations_max_;
  double yield_m_per_N_;
};

}  // namespace forcebound::tissue
