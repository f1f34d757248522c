#pragma once

#include <Eigen/Core>
#include <Eigen/Sparse>
#include <cstddef>
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

/// Column a is the gradient [1/m] of the shape function of corner a of a tetrahedron.
using ShapeGradients = Eigen::Matrix<double, 3, 4>;

[[nodiscard]] std::vector<ShapeGradients> shape_gradients(const TetrahedralMesh& mesh);

/// Where the change of volume is counted in the elastic energy.
enum class VolumeLaw {
  /// in each tetrahedron, as usual. Locks as the ratio nears 0.5: more tetrahedra must keep their volume than nodes can
  /// move.
  per_tetrahedron,
  /// averaged over the tetrahedra around each node (Bonet & Burton 1998), which leaves one constraint per node.
  per_node,
};

/// The stiffness [N/m] of all nodes' displacements, 3 rows per node, none of them held. Between nodes a and b of a
/// tetrahedron of volume V with shape gradients g:
///
///     K_ab = V (lambda g_a g_b' + mu g_b g_a' + mu (g_a . g_b) I)
[[nodiscard]] Eigen::SparseMatrix<double> stiffness_matrix(const TetrahedralMesh& mesh, const ElasticMaterial& material,
                                                           VolumeLaw law = VolumeLaw::per_tetrahedron);

/// The free coordinates when some nodes are held.
class FreeCoordinates {
 public:
  static constexpr int kHeld = -1;

  /// @throws std::invalid_argument for an index that is no node's.
  FreeCoordinates(int nodes, const std::vector<int>& held_nodes);

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] int nodes() const noexcept { return static_cast<int>(first_.size()); }

  /// Of three coordinates that follow each other the first, or kHeld.
  [[nodiscard]] int first_of(int node) const noexcept { return first_[static_cast<std::size_t>(node)]; }

  /// Rows and columns of the free coordinates.
  [[nodiscard]] Eigen::SparseMatrix<double> reduced(const Eigen::SparseMatrix<double>& all) const;

 private:
  std::vector<int> first_;
  int count_ = 0;
};

}  // namespace forcebound::tissue
