#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/server/dynamics/tissue/body_relaxation.hpp"
#include "forcebound/server/dynamics/tissue/corotational_elasticity.hpp"
#include "forcebound/server/dynamics/tissue/corotational_options.hpp"
#include "forcebound/server/dynamics/tissue/deformed_surface.hpp"
#include "forcebound/server/dynamics/tissue/held_stiffness.hpp"
#include "forcebound/server/dynamics/tissue/sphere_pressure.hpp"
#include "forcebound/server/dynamics/tissue/tissue_contact.hpp"

namespace forcebound::server {

/// Where other probes on the same tissue are: ties of points, or centres of spheres.
struct OtherProbes {
  std::span<SurfaceTie> ties{};
  std::span<const scene::Point> centers_m{};
};

/// An elastic body under large motion against a pointed or spherical probe, without friction and quasi-static. Each
/// tetrahedron is linearly elastic in the frame of its own rotation, see CorotationalElasticity.
///
/// *A point* c is tied to a place s of the surface:
///
///     E = elastic energy + k/2 |c - x_s|^2
///
/// The place is found as by TissueModel: where the probe came in, from there always the nearest of the places around as
/// they are deformed. It is let go when the tie pulls with the tissue at rest for the probe's new place.
///
/// *A sphere* has a skin that pushes all of the surface that is in it, see SpherePressure:
///
///     E = elastic energy + energy of the skin at c,   F = -dE/dc
///
/// so that its force has a limit as the tetrahedra get smaller, which that of a point has not: a point sinks into an
/// elastic body without end. Nothing of the past matters, but that the sphere comes the straight way from where it was,
/// in each round of Newton's method no farther than halfway into what is left of its skin. A leap so does not carry it
/// past the surface, to be pushed the wrong way; it stays behind the probe for some steps, or for as long as a place
/// that is held is in its way, and is felt from where it is.
///
/// BodyRelaxation takes E down from where the last step left it. Every change at a fixed c lowers E, so that no motion
/// returns more than it took, converged or not; a tissue that has not converged lags, and says so by its residual.
/// Inverted tetrahedra recover, since their rotations stay rotations.
///
/// *Several probes* on one tissue have one energy. A step moves one probe; the others stay where they are. Of points
/// each holds on where it touched last, and a tie that would pull is left out of that step: one that comes back so may
/// bring up to k/2 times the square of what it is stretched by.
///
/// Real time: `step` is noexcept, allocates nothing, and takes bounded time: at most iterations_max times what
/// BodyRelaxation takes for linear_iterations_max. Immutable, hence shared; each state has a body of its own.
class CorotationalTissue {
 public:
  /// @throws std::invalid_argument for a material or options that `check` refuses, and for a node that does not exist
  /// @throws std::runtime_error beginning with the mesh's name, if the held nodes leave the body free to move, and for
  /// a sphere that SpherePressure refuses.
  CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& held_nodes,
                     const CorotationalOptions& options);

  [[nodiscard]] const TetrahedralMesh& mesh() const noexcept { return mesh_; }
  [[nodiscard]] const StiffnessFactors& factors() const noexcept { return factors_; }

  /// Of a sphere; none of a point.
  [[nodiscard]] const std::optional<SpherePressure>& pressure() const noexcept { return pressure_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  [[nodiscard]] CorotationalBody make_body() const;

  /// Puts the nodes elsewhere, by three coordinates [m] each. Those of held nodes stay there from then on.
  void deform(CorotationalBody& body, const Eigen::VectorXd& displacement_m) const noexcept;

  TissueResult step(TissueState& state, CorotationalBody& body, const scene::Point& probe_m,
                    const OtherProbes& others = {}) const noexcept;

 private:
  TetrahedralMesh mesh_;
  CorotationalOptions options_;
  TissueSurface surface_;
  CorotationalElasticity elasticity_;
  StiffnessFactors factors_;
  std::optional<SpherePressure> pressure_;
  double tolerance_m_ = 0;
};

}  // namespace forcebound::server
