#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "forcebound/tissue/elasticity.hpp"
#include "forcebound/tissue/rotation.hpp"

namespace forcebound::tissue {

/// A deformed body: three coordinates of displacement [m] per node, and its energy and forces.
struct DeformedBody {
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd force_N;  ///< with which the body pushes its nodes back
  double energy_J = 0;
  std::vector<PolarParts> parts;  ///< of each tetrahedron's deformation
};

/// A tetrahedron's resistance to small motions of its nodes, in the fixed frame.
struct LinearisedTetrahedron {
  Eigen::Matrix3d gradients;    ///< [1/m] of the last three corners' shape functions, in columns, turned with it
  Eigen::Matrix3d turning_N_m;  ///< what it resists turning: the stress's twist by the displacement gradient's
};

/// Tetrahedra, each linearly elastic in the frame of its own rotation R, the nearest to its deformation F:
///
///     E = sum over tetrahedra V (mu |F - R|^2 + lambda/2 (tr(R'F) - 3)^2)
///     dE = V P : dF,   P = R (2 mu (S - I) + lambda tr(S - I) I),   F = R S
///     dP = R (2 mu (T - [w]x) + lambda tr(T) I + lambda tr(S - I) [w]x),   T = R'dF,   (tr(S) I - S) w = twist T
///
/// The last line is the whole second derivative, how R turns along with it included (McAdams et al. 2011); of a
/// tetrahedron that is flat or inside out R counts as held in it, the warped stiffness of Mueller & Gross 2004.
///
/// Real time: all but the constructor and `at_rest` is noexcept, allocates nothing and passes once over the tetrahedra.
/// Immutable.
class CorotationalElasticity {
 public:
  CorotationalElasticity(const TetrahedralMesh& mesh, const ElasticMaterial& material);

  [[nodiscard]] DeformedBody at_rest() const;

  /// Computes all else from the displacement.
  /// @param near start values for the rotations, for speed; may be the same body
  void evaluate(DeformedBody& body, const DeformedBody& near) const noexcept;

  /// Approximate rotation of each node: the mean of the tetrahedra around it.
  void find_turns(const DeformedBody& body, std::vector<Eigen::Quaterniond>& of_nodes) const noexcept;

  /// @param linearised as many as there are tetrahedra
  void linearise(const DeformedBody& body, std::vector<LinearisedTetrahedron>& linearised) const noexcept;

  /// The forces [N] for small motions [m]: the second derivative of E times them.
  void resist(const std::vector<LinearisedTetrahedron>& linearised, const Eigen::VectorXd& moved_m,
              Eigen::VectorXd& force_N) const noexcept;

  [[nodiscard]] std::size_t memory_bytes() const noexcept { return elements_.size() * sizeof(Element); }

 private:
  struct Element {
    std::array<Eigen::Index, 4> first;  // coordinates of the corners
    Eigen::Matrix3d gradients;          // of the last three corners
    double volume_m3;
  };

  std::vector<Element> elements_;
  Eigen::Index coordinates_;
  double mu_Pa_;
  double lambda_Pa_;
};

}  // namespace forcebound::tissue
