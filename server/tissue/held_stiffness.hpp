#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <string>
#include <vector>

namespace forcebound::server {

using SparseCholesky = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

/// Factorises the stiffness of a body's free coordinates.
/// @param name of the body, for messages. @throws std::runtime_error unless the held ones keep it in its place.
void factorise(SparseCholesky& cholesky, const Eigen::SparseMatrix<double>& stiffness, const std::string& name);

/// P^-1 L D L' P of a stiffness, in the form that a solve without the heap asks for.
class StiffnessFactors {
 public:
  StiffnessFactors() = default;
  explicit StiffnessFactors(const SparseCholesky& cholesky);

  /// Real time: noexcept, no allocation. All vectors are as long as the stiffness, and none is another one.
  void solve(const Eigen::VectorXd& right, Eigen::VectorXd& solved, Eigen::VectorXd& scratch) const noexcept;

 private:
  Eigen::SparseMatrix<double> lower_;  // unit diagonal left out
  Eigen::VectorXd pivots_;
  std::vector<int> permuted_;
};

}  // namespace forcebound::server
