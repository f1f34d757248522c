#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cstddef>
#include <string>
#include <vector>

#include "forcebound/tissue/elasticity.hpp"

namespace forcebound::tissue {

/// Orders nodes (three consecutive coordinates each) for little fill-in.
struct NodeOrdering {
  using PermutationType = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

  /// @param stiffness both triangles of it. @param order as Eigen's own orderings give it
  void operator()(const Eigen::SparseMatrix<double>& stiffness, PermutationType& order) const;
};

using SparseCholesky = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, NodeOrdering>;

/// Factorises the stiffness of a body's free coordinates.
/// @param name of the body, for messages. @throws std::runtime_error unless some nodes are free, and the held ones fix
/// its position.
void factorise(SparseCholesky& cholesky, const Eigen::SparseMatrix<double>& stiffness, const std::string& name);

/// P^-1 L D L' P of a stiffness, in blocks of a node's three coordinates, for a solve without the heap.
class StiffnessFactors {
 public:
  StiffnessFactors() = default;
  StiffnessFactors(const SparseCholesky& cholesky, const FreeCoordinates& free);

  /// Displacements of the nodes under forces, where the stiffness has turned with each node. Vectors have the
  /// coordinates of all nodes; those of held nodes are ignored and unchanged. The vectors must be distinct. Real time:
  /// noexcept, no allocation.
  /// @param turns of all nodes
  void solve(const std::vector<Eigen::Quaterniond>& turns, const Eigen::VectorXd& force_N, Eigen::VectorXd& moved_m,
             Eigen::VectorXd& scratch) const noexcept;

  /// Displacements of some nodes under forces on them: three rows and columns each, symmetric to the last bit, zero for
  /// held ones. Solves for many forces at once, with L no farther than it reaches. At set-up.
  [[nodiscard]] Eigen::MatrixXd compliance_m_per_N(const std::vector<int>& nodes) const;

  /// Blocks of L below the diagonal: a solve passes over them twice.
  [[nodiscard]] std::size_t blocks() const noexcept { return blocks_.size(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  // Forces on 16 nodes, or displacements under them: a column for each coordinate of these, rows in the factors' order.
  using Panel = Eigen::Matrix<double, Eigen::Dynamic, 48, Eigen::RowMajor>;

  void add_column(const Eigen::SparseMatrix<double>& lower, const Eigen::VectorXd& pivots, Eigen::Index column);
  void solve_from(std::size_t from, Panel& panel) const;

  std::vector<Eigen::Index> first_;      // of each node in the factors' order, among all coordinates
  std::vector<Eigen::Matrix3d> yields_;  // blocks of D^-1
  std::vector<std::size_t> begin_;       // of each column of blocks, and the end
  std::vector<Eigen::Index> row_;        // of each block below the diagonal, times three
  std::vector<Eigen::Matrix3d> blocks_;  // of L, which has ones on the diagonal
};

}  // namespace forcebound::tissue
