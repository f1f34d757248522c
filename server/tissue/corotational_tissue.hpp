#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "forcebound/server/tissue/corotational_elasticity.hpp"
#include "forcebound/server/tissue/deformed_surface.hpp"
#include "forcebound/server/tissue/held_stiffness.hpp"
#include "forcebound/server/tissue/tissue_contact.hpp"

namespace forcebound::server {

struct CorotationalOptions {
  /// A stiffer tie than that converges too slowly to be felt as what it is.
  static constexpr double kContactStiffnessMost_N_per_m = 1e4;

  double contact_stiffness_N_per_m = 1e3;  ///< between the probe and the place where it touches, > 0
  int iterations_max = 4;                  ///< of Newton's method in one step, >= 1
  int linear_iterations_max = 15;          ///< of conjugate gradients in each, >= 1
  double tolerance = 1e-4;                 ///< residual accepted, as a share of the surface's mean edge

  /// @throws std::invalid_argument unless all are as said above.
  void check() const;
};

/// A tissue as it is deformed now, and the memory of a step.
struct CorotationalBody {
  DeformedBody now;
  DeformedBody trial;
  std::vector<LinearisedTetrahedron> linearised;
  std::vector<Eigen::Quaterniond> turns;  ///< of the nodes
  Eigen::VectorXd direction, residual, preconditioned, search, product, scratch;
  bool at_rest = true;  ///< the last step converged

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// An elastic body under large motion against a pointed probe, without friction and quasi-static. Each tetrahedron is
/// linearly elastic in the frame of its own rotation, see CorotationalElasticity, and the probe c is tied to a place s
/// of the surface:
///
///     E = elastic energy + k/2 |c - x_s|^2
///
/// The place is found as by TissueModel: where the probe came in, from there always the nearest of the places around as
/// they are deformed. It is let go when the tie pulls with the tissue at rest for the probe's new place. Newton's
/// method with the whole second derivative, conjugate gradients preconditioned by the factors of the stiffness at rest,
/// turned with each node, and a line search take E down from where the last step left it. Every change at a fixed c
/// lowers E, so that no motion returns more than it took, converged or not; a tissue that has not converged lags, and
/// says so by its residual. Inverted tetrahedra recover, since their rotations stay rotations.
///
/// *Several probes* on one tissue have one energy, with a tie each. A step moves one probe; the others hold on where
/// they touched last, and what would pull is left out of that step. A tie that comes back so may bring up to k/2 times
/// the square of what it is stretched by.
///
/// Real time: `step` is noexcept, allocates nothing, and takes bounded time: at most iterations_max times (8 + 1)
/// passes over the tetrahedra and linear_iterations_max over the blocks of their stiffness, with a solution by the
/// factors each. Immutable, hence shared; each state has a body of its own.
class CorotationalTissue {
 public:
  /// @throws std::invalid_argument for a material or options that `check` refuses, and for a node that does not exist
  /// @throws std::runtime_error beginning with the mesh's name, if the held nodes leave the body free to move.
  CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& held_nodes,
                     const CorotationalOptions& options);

  [[nodiscard]] const TetrahedralMesh& mesh() const noexcept { return mesh_; }
  [[nodiscard]] const StiffnessFactors& factors() const noexcept { return factors_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

  [[nodiscard]] CorotationalBody make_body() const;

  /// Puts the nodes elsewhere, by three coordinates [m] each. Those of held nodes stay there from then on.
  void deform(CorotationalBody& body, const Eigen::VectorXd& displacement_m) const noexcept;

  /// @param others on the same tissue
  TissueResult step(TissueState& state, CorotationalBody& body, const Point& probe_m,
                    std::span<SurfaceTie> others = {}) const noexcept;

 private:
  class Step;

  TetrahedralMesh mesh_;
  CorotationalOptions options_;
  TissueSurface surface_;
  CorotationalElasticity elasticity_;
  StiffnessFactors factors_;
  double tolerance_m_ = 0;
};

}  // namespace forcebound::server
