#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "forcebound/server/tissue/elasticity.hpp"
#include "forcebound/server/tissue/held_stiffness.hpp"
#include "forcebound/server/tissue/tissue_contact.hpp"

namespace forcebound::server {

struct CorotationalOptions {
  double contact_stiffness_N_per_m = 1e3;  ///< between the probe and the place where it touches
  int iterations_max = 4;                  ///< of Newton's method in one step, >= 1
  int linear_iterations_max = 30;          ///< of conjugate gradients in each, >= 1
  double tolerance = 1e-5;                 ///< residual accepted, as a share of the surface's mean edge

  /// @throws std::invalid_argument unless all are as said above.
  void check() const;
};

/// A probe that holds a place of the surface.
struct CorotationalTie {
  SurfacePlace place;
  Point probe_m = Point::Zero();
  bool pulls = false;  ///< would pull, hence is left out: found in each step anew
};

/// Memory of a step, not of the tissue: one for any number of models' states that are stepped one after the other.
struct CorotationalWorkspace {
  std::vector<Eigen::Matrix3d> rotations;
  Eigen::VectorXd force, trial, trial_force, direction, residual, preconditioned, search, product;
};

/// An elastic body under large motion against a pointed probe, without friction and quasi-static. Each tetrahedron of
/// deformation F is linearly elastic in the frame of its own rotation R, the nearest to F:
///
///     E = sum over tetrahedra V (mu |F - R|^2 + lambda/2 (tr(R'F) - 3)^2) + k/2 |c - x_s|^2
///
/// The probe c is tied to a place s of the surface, found as by TissueModel: where it came in, from there always the
/// nearest of the places around as they are deformed. It is let go when the tie would pull. Newton's method with the
/// rotations held (warped stiffness), conjugate gradients preconditioned by the factors of the stiffness at rest, and a
/// line search take E down from where the last step left it. Every change at a fixed c lowers E, so that no motion
/// returns more than it took, converged or not; a tissue that has not converged lags, and says so by its residual.
/// Inverted tetrahedra recover, since R stays a rotation.
///
/// *Several probes* on one tissue have one energy, with a tie each. A step moves one probe; the others hold on where
/// they touched last, and what would pull is left out.
///
/// A state is a TissueState and three coordinates of displacement [m] per node of the mesh, all zero at rest.
///
/// Real time: `step` is noexcept, allocates nothing, and takes bounded time, about iterations_max times
/// linear_iterations_max passes over the tetrahedra. Immutable, hence shared; it takes some 0.6 kB per tetrahedron.
class CorotationalTissue {
 public:
  /// @throws std::invalid_argument for a material or options that `check` refuses, and for a node that does not exist
  /// @throws std::runtime_error beginning with the mesh's name, if the held nodes leave the body free to move.
  CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& held_nodes,
                     const CorotationalOptions& options);

  [[nodiscard]] const TetrahedralMesh& mesh() const noexcept { return mesh_; }

  /// How many displacements a state has.
  [[nodiscard]] std::size_t coordinates() const noexcept { return 3 * mesh_.nodes_m().size(); }

  [[nodiscard]] CorotationalWorkspace make_workspace() const;

  /// Displacements of held nodes are not looked at, and stay.
  /// @param others on the same tissue
  TissueResult step(TissueState& state, std::span<double> displacement_m, CorotationalWorkspace& workspace,
                    const Point& probe_m, std::span<CorotationalTie> others = {}) const noexcept;

  /// The elastic energy [J] of a displacement, and the forces [N] with which the tissue pushes its nodes back.
  double elastic_energy(std::span<const double> displacement_m, std::span<double> force_N,
                        CorotationalWorkspace& workspace) const noexcept;

 private:
  class Step;

  TetrahedralMesh mesh_;
  ElasticMaterial material_;
  CorotationalOptions options_;
  TissueSurface surface_;
  std::vector<ShapeGradients> gradients_;
  FreeCoordinates free_;
  StiffnessFactors factors_;
  double tolerance_m_ = 0;
};

}  // namespace forcebound::server
