#include "forcebound/tissue/elasticity.hpp"

#include <stdexcept>
#include <string>

namespace forcebound::tissue {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

}  // namespace

Eigen::SparseMatrix<double> stiffness_matrix(const TetrahedralMesh& mesh, const ElasticMaterial& material) {
  const ElasticElements elements(mesh, material);
  Triplets triplets;
  const std::size_t rows = 3 * elements.nodes_each();
  triplets.reserve(rows * rows * elements.count());
  for (std::size_t element = 0; element < elements.count(); ++element) {
    const std::vector<int> at = elements.nodes_of(element);
    const Eigen::MatrixXd stiffness = elements.stiffness_N_per_m(element);
    for (Eigen::Index column = 0; column < stiffness.cols(); ++column) {
      for (Eigen::Index row = 0; row < stiffness.rows(); ++row) {
        triplets.emplace_back(3 * at[row / 3] + row % 3, 3 * at[column / 3] + column % 3, stiffness(row, column));
      }
    }
  }
  const auto size = 3 * static_cast<Eigen::Index>(mesh.nodes_m().size());
  Eigen::SparseMatrix<double> sum(size, size);
  sum.setFromTriplets(triplets.begin(), triplets.end());
  return sum;
}

FreeCoordinates::FreeCoordinates(int nodes, const std::vector<int>& held_nodes) : first_(nodes, 0) {
  for (const int node : held_nodes) {
    if (node < 0 || node >= nodes) {
      throw std::invalid_argument("held node " + std::to_string(node) + " does not exist: expected 0 to " +
                                  std::to_string(nodes - 1));
    }
    first_[node] = kHeld;
  }
  for (int& first : first_) {
    if (first == kHeld) continue;
    first = count_;
    count_ += 3;
  }
}

Eigen::SparseMatrix<double> FreeCoordinates::reduced(const Eigen::SparseMatrix<double>& all) const {
  Triplets triplets;
  triplets.reserve(static_cast<std::size_t>(all.nonZeros()));
  const auto index = [&](Eigen::Index coordinate) {
    const int first = first_of(static_cast<int>(coordinate / 3));
    return first == kHeld ? kHeld : first + static_cast<int>(coordinate % 3);
  };
  for (Eigen::Index column = 0; column < all.outerSize(); ++column) {
    if (index(column) == kHeld) continue;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(all, column); entry; ++entry) {
      if (index(entry.row()) != kHeld) triplets.emplace_back(index(entry.row()), index(column), entry.value());
    }
  }
  Eigen::SparseMatrix<double> free(count_, count_);
  free.setFromTriplets(triplets.begin(), triplets.end());
  return free;
}

}  // namespace forcebound::tissue
