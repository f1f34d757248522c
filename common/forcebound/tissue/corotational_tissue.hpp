#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/tissue/body_relaxation.hpp"
#include "forcebound/tissue/corotational_elasticity.hpp"
#include "forcebound/tissue/corotational_options.hpp"
#include "forcebound/tissue/deformed_surface.hpp"
#include "forcebound/tissue/held_stiffness.hpp"
#include "forcebound/tissue/sphere_pressure.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

namespace forcebound::tissue {

/// Other probes on the same tissue: ties of points, or centres of spheres.
struct OtherProbes {
  std::span<SurfaceTie> ties{};
  std::span<const scene::Point> centers_m{};
};

/// An elastic body under large motion against a pointed or spherical probe, without friction and quasi-static. Each
/// element is linearly elastic in the frame of its own rotation, see CorotationalElasticity.
///
/// *A point* c is tied to a place s of the surface:
///
///     E = elastic energy + k/2 |c - x_s|^2
///
/// The place is found as in TissueModel: where the probe came in, and from there always the nearest of the surrounding
/// deformed places. It is released when the tie pulls with the tissue at rest for the probe's new position.
///
/// *A sphere* has a skin that pushes all of the surface within it, see SpherePressure:
///
///     E = elastic energy + energy of the skin at c,   F = -dE/dc
///
/// so that its force converges as the elements get smaller, unlike that of a point, which sinks into an elastic body
/// without end. The past has no influence, except that the sphere comes on a straight line from its last position, in
/// each round of Newton's method no farther than halfway into the rest of its skin. So a jump does not carry it past
/// the surface, to be pushed the wrong way; it stays behind the probe for some steps, or for as long as a held place is
/// in its way, and its force is that at its own position.
///
/// BodyRelaxation takes E down from where the last step left it. Every change at a fixed c lowers E, so that no motion
/// returns more than it took, converged or not; a tissue that has not converged lags, which its residual shows.
/// Inverted elements recover, since their rotations stay rotations.
///
/// *Several probes* on one tissue have one energy. A step moves one probe; the others stay where they are. Each of the
/// points keeps its last place, and a tie that would pull is left out of that step: one that returns may add up to k/2
/// times the square of its stretch.
///
/// Real time: `step` is noexcept, allocates nothing, and takes bounded time: at most iterations_max times that of
/// BodyRelaxation with linear_iterations_max. Immutable, hence shared; each state has a body of its own.
class CorotationalTissue {
 public:
  /// @throws std::invalid_argument for a material or options that `check` refuses, and for a node that does not exist
  /// @throws std::runtime_error beginning with the mesh's name, if the held nodes leave the body free to move, and for
  /// a sphere that SpherePressure refuses.
  CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& held_nodes,
                     const CorotationalOptions& options);

  [[nodiscard]] const TetrahedralMesh& mesh() const noexcept { return mesh_; }
  [[nodiscard]] const CorotationalOptions& options() const noexcept { return options_; }
  [[nodiscard]] const TissueSurface& surface() const noexcept { return surface_; }  ///< at rest
  [[nodiscard]] const StiffnessFactors& factors() const noexcept { return factors_; }

  /// Of a sphere; none of a point.
  [[nodiscard]] const std::optional<SpherePressure>& pressure() const noexcept { return pressure_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  [[nodiscard]] CorotationalBody make_body() const;

  /// Moves the nodes, by three coordinates [m] each. Those of held nodes stay there from then on.
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

}  // namespace forcebound::tissue
