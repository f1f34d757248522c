#pragma once

#include <Eigen/Core>
#include <Eigen/Sparse>
#include <cstddef>
#include <vector>

#include "forcebound/tissue/elastic_elements.hpp"

namespace forcebound::tissue {

/// The stiffness [N/m] of all nodes' displacements, 3 rows per node, none of them held: the sum of its elements'.
[[nodiscard]] Eigen::SparseMatrix<double> stiffness_matrix(const TetrahedralMesh& mesh,
                                                           const ElasticMaterial& material);

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
