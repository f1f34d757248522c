#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "forcebound/tissue/tetrahedral_mesh.hpp"

namespace forcebound::tissue {

/// An isotropic elastic material.
struct ElasticMaterial {
  double young_Pa = 0;  ///< Young's modulus, > 0
  double poisson = 0;   ///< Poisson's ratio, > -1 and < 0.5

  [[nodiscard]] double mu_Pa() const noexcept { return young_Pa / (2 * (1 + poisson)); }
  [[nodiscard]] double lambda_Pa() const noexcept { return young_Pa * poisson / ((1 + poisson) * (1 - 2 * poisson)); }

  /// @throws std::invalid_argument unless both are within the bounds above.
  void check() const;
};

/// The elements of a body, whose elastic energies add up to its own: 1/2 u'K u each, u being the displacements of its
/// nodes. Which they are is up to the mesh:
///
/// * boxes, of eight nodes with enhanced assumed strain (Simo & Rifai 1990): beside the strain of the nodes each has 15
///   modes of its own, which take the values of least energy. That is the 9 of their first element, by which a box
///   bends as a beam does, and the 6 bilinear stretches, without which it locks as Poisson's ratio nears 0.5.
/// * tetrahedra of ten nodes, where there are middles: quadratic, with the change of volume averaged over each, so that
///   there is one constraint on it for each tetrahedron.
/// * tetrahedra of four nodes: the strain is constant in each, so they are much too stiff in bending, and lock.
///
/// The mesh must outlive it. Immutable.
class ElasticElements {
 public:
  /// @throws std::invalid_argument for a material that `check` refuses
  ElasticElements(const TetrahedralMesh& mesh, const ElasticMaterial& material);

  [[nodiscard]] std::size_t count() const noexcept { return mesh_.elements(); }
  [[nodiscard]] std::size_t nodes_each() const noexcept;

  /// The nodes of an element, in the order of the rows below.
  [[nodiscard]] std::vector<int> nodes_of(std::size_t element) const;

  /// Whether all are alike but for their place.
  [[nodiscard]] bool alike() const noexcept { return !mesh_.boxes().empty(); }

  /// K [N/m], three rows and columns for each node.
  [[nodiscard]] Eigen::MatrixXd stiffness_N_per_m(std::size_t element) const;

  /// In columns the gradient of each node's shape function [1/m], averaged over the element.
  [[nodiscard]] Eigen::Matrix3Xd mean_gradients_per_m(std::size_t element) const;

 private:
  const TetrahedralMesh& mesh_;
  ElasticMaterial material_;
  Eigen::MatrixXd of_box_;  // stiffness; empty where there is none
};

}  // namespace forcebound::tissue
