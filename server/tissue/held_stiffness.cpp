#include "forcebound/server/tissue/held_stiffness.hpp"

#include <stdexcept>

namespace forcebound::server {
namespace {

// A pivot this much smaller than the stiffness it began as is rounding: nothing holds what it stands for.
constexpr double kNotHeld = 1e-13;

}  // namespace

void factorise(SparseCholesky& cholesky, const Eigen::SparseMatrix<double>& stiffness, const std::string& name) {
  cholesky.compute(stiffness);
  const Eigen::VectorXd stiffnesses = cholesky.permutationP() * Eigen::VectorXd(stiffness.diagonal());
  if (cholesky.info() == Eigen::Success && (cholesky.vectorD().array() > kNotHeld * stiffnesses.array()).all()) {
    return;
  }
  throw std::runtime_error(name +
                           ": the held nodes leave the tissue free to move or to turn: hold at least three nodes, " +
                           "not in a line, of each part that hangs together");
}

StiffnessFactors::StiffnessFactors(const SparseCholesky& cholesky)
    : lower_(cholesky.matrixL().nestedExpression()), pivots_(cholesky.vectorD()) {
  const auto& order = cholesky.permutationP().indices();
  permuted_.assign(order.data(), order.data() + order.size());
}

void StiffnessFactors::solve(const Eigen::VectorXd& right, Eigen::VectorXd& solved,
                             Eigen::VectorXd& scratch) const noexcept {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  const Eigen::Index size = lower_.rows();
  for (Eigen::Index row = 0; row < size; ++row) scratch[permuted_[row]] = right[row];
  for (Eigen::Index column = 0; column < size; ++column) {
    for (Entry entry(lower_, column); entry; ++entry) {
      if (entry.row() > column) scratch[entry.row()] -= entry.value() * scratch[column];
    }
  }
  for (Eigen::Index row = 0; row < size; ++row) scratch[row] /= pivots_[row];
  for (Eigen::Index column = size - 1; column >= 0; --column) {
    for (Entry entry(lower_, column); entry; ++entry) {
      if (entry.row() > column) scratch[column] -= entry.value() * scratch[entry.row()];
    }
  }
  for (Eigen::Index row = 0; row < size; ++row) solved[row] = scratch[permuted_[row]];
}

}  // namespace forcebound::server
