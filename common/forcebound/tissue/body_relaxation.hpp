#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <vector>

#include "forcebound/tissue/corotational_elasticity.hpp"
#include "forcebound/tissue/held_stiffness.hpp"
#include "forcebound/tissue/sphere_pressure.hpp"

namespace forcebound::tissue {

/// A tissue's present deformation, and scratch memory of a step.
struct CorotationalBody {
  DeformedBody now;
  DeformedBody trial;
  LinearisedBody linearised;
  std::vector<Eigen::Quaterniond> turns;  ///< of the nodes
  Eigen::VectorXd direction, residual, preconditioned, search, product, scratch;
  PressedTriangles pressed;  ///< by spheres; none for points
  bool at_rest = true;       ///< the last step converged

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// An energy of a body's displacement (three coordinates [m] per node), beside its elastic one. Real time: noexcept, no
/// allocation, bounded.
class BodyContact {
 public:
  virtual ~BodyContact() = default;

  /// Infinite where the position is forbidden.
  [[nodiscard]] virtual double energy_J(const Eigen::VectorXd& displacement_m) const noexcept = 0;

  /// Forces on the nodes: the negative gradient of the energy.
  virtual void add_forces(const Eigen::VectorXd& displacement_m, Eigen::VectorXd& force_N) const noexcept = 0;

  /// Sets the displacement at which add_resistance works; it must not change until then.
  virtual void linearise(const Eigen::VectorXd& displacement_m) noexcept = 0;

  /// The second derivative times small motions of the nodes.
  virtual void add_resistance(const Eigen::VectorXd& moved_m, Eigen::VectorXd& force_N) const noexcept = 0;
};

/// Minimises the energy of a body and of its contacts: Newton's method with the whole second derivative, conjugate
/// gradients preconditioned by the factors of the stiffness at rest, turned with each node, and a line search.
///
/// Real time: noexcept, no allocation; `improve` makes at most 8 + 1 passes over the elements, and up to the given
/// number of passes over them again, each with a solution by the factors.
class BodyRelaxation {
 public:
  /// @param contact all must outlive it. The nodes' rotations are those of the present body.
  BodyRelaxation(const CorotationalElasticity& elasticity, const StiffnessFactors& factors, CorotationalBody& body,
                 BodyContact& contact) noexcept;

  /// The displacement that the remaining forces on the nodes would cause with the stiffness at rest.
  double find_residual_m() noexcept;

  /// One round of Newton's method, after find_residual_m. False if no step lowers the energy.
  /// @param moved_m_most bound on the change of any coordinate of a node
  bool improve(int linear_iterations_max, double moved_m_most = std::numeric_limits<double>::infinity()) noexcept;

  /// Whether the body is at rest within the tolerance; then sets it exactly at rest.
  bool settle(double tolerance_m) noexcept;

  [[nodiscard]] double energy_J() const noexcept {
    return body_.now.energy_J + contact_.energy_J(body_.now.displacement_m);
  }

 private:
  void find_total_force() noexcept;
  void precondition() noexcept;
  void solve_linearised(int iterations_max) noexcept;
  bool search_along(double share) noexcept;

  const CorotationalElasticity& elasticity_;
  const StiffnessFactors& factors_;
  CorotationalBody& body_;
  BodyContact& contact_;
};

}  // namespace forcebound::tissue
