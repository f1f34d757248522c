#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "forcebound/tissue/elastic_elements.hpp"
#include "forcebound/tissue/rotation.hpp"

namespace forcebound::tissue {

/// A deformed body: three coordinates of displacement [m] per node, and its energy and forces.
struct DeformedBody {
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd force_N;  ///< with which the body pushes its nodes back
  double energy_J = 0;
  std::vector<PolarParts> parts;  ///< of each element's mean deformation
};

/// A body's resistance to small motions of its nodes, of one element after the other.
struct LinearisedBody {
  struct Frame {
    Eigen::Matrix3d rotation;       ///< R
    Eigen::Matrix3d stretch;        ///< S
    Eigen::Matrix3d turn_by_twist;  ///< (tr(S) I - S)^-1; zero: R counts as held
    Eigen::Vector3d twist_N_m;      ///< t
  };
  std::vector<Frame> frames;
  Eigen::Matrix3Xd places_m;  ///< y, a column for each node of each element
  Eigen::Matrix3Xd pushes_N;  ///< q
};

/// Elements, each linearly elastic in the frame of its own rotation R, the nearest to its mean deformation F:
///
///     E = sum over elements 1/2 d'K d,   d_a = y_a - X_a,   y_a = R'x_a,   F = sum over nodes x_a g_a' = R S
///     dE = sum over nodes (q_a - t x g_a) . R'dx_a,   q = K d,   t = (tr(S) I - S)^-1 sum over nodes y_a x q_a
///
/// with places X at rest and x, relative to the first node, and mean gradients g of shape functions. The term of t is
/// how R turns along; it vanishes for tetrahedra of four nodes, for which
///
///     E = sum over tetrahedra V (mu |F - R|^2 + lambda/2 (tr(R'F) - 3)^2)
///
/// `resist` is the whole second derivative. Of an element that is flat or inside out R counts as held in both, the
/// warped stiffness of Mueller & Gross 2004; E remains what it is.
///
/// Real time: all but the constructor, `at_rest` and `make_linearised` is noexcept, allocates nothing and passes once
/// over the elements. Immutable.
class CorotationalElasticity {
 public:
  CorotationalElasticity(const TetrahedralMesh& mesh, const ElasticMaterial& material);

  [[nodiscard]] DeformedBody at_rest() const;
  [[nodiscard]] LinearisedBody make_linearised() const;
  [[nodiscard]] std::size_t elements() const noexcept { return first_.size() / nodes_each_; }

  /// Computes all else from the displacement.
  /// @param near start values for the rotations, for speed; may be the same body
  void evaluate(DeformedBody& body, const DeformedBody& near) const noexcept;

  /// Approximate rotation of each node: the mean of the elements around it.
  void find_turns(const DeformedBody& body, std::vector<Eigen::Quaterniond>& of_nodes) const noexcept;

  void linearise(const DeformedBody& body, LinearisedBody& linearised) const noexcept;

  /// The forces [N] for small motions [m]: the second derivative of E times them.
  void resist(const LinearisedBody& linearised, const Eigen::VectorXd& moved_m,
              Eigen::VectorXd& force_N) const noexcept;

  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  // Of an element of that many nodes.
  template <int kNodes>
  struct Element;
  template <int kNodes>
  [[nodiscard]] Element<kNodes> element(std::size_t number) const noexcept;
  // Calls with the number of nodes of each element as a constant.
  template <typename Do>
  void with_nodes_each(const Do& act) const noexcept;
  template <int kNodes>
  void evaluate_each(DeformedBody& body, const DeformedBody& near) const noexcept;
  template <int kNodes>
  void linearise_each(const DeformedBody& body, LinearisedBody& linearised) const noexcept;
  template <int kNodes>
  void resist_each(const LinearisedBody& linearised, const Eigen::VectorXd& moved_m,
                   Eigen::VectorXd& force_N) const noexcept;

  std::size_t nodes_each_;
  std::vector<Eigen::Index> first_;  // coordinate of each node of each element
  bool alike_;                       // the following are of one element for all
  Eigen::Matrix3Xd rest_m_;          // X of the nodes of one element after the other
  Eigen::Matrix3Xd gradients_;       // g
  Eigen::MatrixXd stiffness_;        // K
  Eigen::Index coordinates_;
};

}  // namespace forcebound::tissue
