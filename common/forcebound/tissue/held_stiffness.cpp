#include "forcebound/tissue/held_stiffness.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <stdexcept>

namespace forcebound::tissue {
namespace {

// A pivot this much smaller than its initial stiffness is rounding: nothing holds that coordinate.
constexpr double kNotHeld = 1e-13;

}  // namespace

void NodeOrdering::operator()(const Eigen::SparseMatrix<double>& stiffness, PermutationType& order) const {
  std::vector<Eigen::Triplet<double>> neighbours;
  for (Eigen::Index column = 0; column < stiffness.outerSize(); column += 3) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(stiffness, column); entry; ++entry) {
      neighbours.emplace_back(entry.row() / 3, column / 3, 1.0);
    }
  }
  const Eigen::Index nodes = stiffness.cols() / 3;
  Eigen::SparseMatrix<double> graph(nodes, nodes);
  graph.setFromTriplets(neighbours.begin(), neighbours.end());
  PermutationType of_nodes;
  Eigen::AMDOrdering<int>()(graph, of_nodes);
  order.resize(stiffness.cols());
  for (Eigen::Index k = 0; k < order.size(); ++k) {
    order.indices()[k] = 3 * of_nodes.indices()[k / 3] + static_cast<int>(k % 3);
  }
}

void factorise(SparseCholesky& cholesky, const Eigen::SparseMatrix<double>& stiffness, const std::string& name) {
  if (stiffness.rows() == 0) throw std::runtime_error(name + ": all nodes are held: expected some that can move");
  cholesky.compute(stiffness);
  const Eigen::VectorXd stiffnesses = cholesky.permutationP() * Eigen::VectorXd(stiffness.diagonal());
  if (cholesky.info() == Eigen::Success && (cholesky.vectorD().array() > kNotHeld * stiffnesses.array()).all()) {
    return;
  }
  throw std::runtime_error(name +
                           ": the held nodes leave the tissue free to move or to turn: hold at least three nodes, " +
                           "not in a line, of each connected part");
}

StiffnessFactors::StiffnessFactors(const SparseCholesky& cholesky, const FreeCoordinates& free)
    : first_(static_cast<std::size_t>(free.count() / 3)) {
  for (int node = 0; node < free.nodes(); ++node) {
    const int free_coordinate = free.first_of(node);
    if (free_coordinate == FreeCoordinates::kHeld) continue;
    first_[cholesky.permutationP().indices()[free_coordinate] / 3] = 3 * static_cast<Eigen::Index>(node);
  }
  const Eigen::SparseMatrix<double> lower = cholesky.matrixL().nestedExpression();
  const Eigen::VectorXd pivots = cholesky.vectorD();
  begin_.push_back(0);
  for (Eigen::Index column = 0; column < lower.cols(); column += 3) add_column(lower, pivots, column);
}

// L of three columns, and D, from a factorisation by single coordinates: with the ones and what is below them in
// triangle T, L T^-1 and T D T'.
void StiffnessFactors::add_column(const Eigen::SparseMatrix<double>& lower, const Eigen::VectorXd& pivots,
                                  Eigen::Index column) {
  Eigen::Matrix3d triangle = Eigen::Matrix3d::Identity();
  std::map<Eigen::Index, Eigen::Matrix3d> below;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower, column + axis); entry; ++entry) {
      const Eigen::Index node = entry.row() / 3 * 3;
      if (node == column) {
        triangle(entry.row() - column, axis) = entry.row() == column + axis ? 1 : entry.value();
      } else {
        below.try_emplace(node, Eigen::Matrix3d::Zero()).first->second(entry.row() - node, axis) = entry.value();
      }
    }
  }
  const Eigen::Matrix3d back = triangle.inverse();
  const Eigen::Vector3d yields = pivots.segment<3>(column).cwiseInverse();
  yields_.emplace_back(back.transpose() * yields.asDiagonal() * back);
  for (const auto& [row, block] : below) {
    row_.push_back(row);
    blocks_.emplace_back(block * back);
  }
  begin_.push_back(blocks_.size());
}

void StiffnessFactors::solve(const std::vector<Eigen::Quaterniond>& turns, const Eigen::VectorXd& force_N,
                             Eigen::VectorXd& moved_m, Eigen::VectorXd& scratch) const noexcept {
  const std::size_t size = first_.size();
  const auto turn = [&](std::size_t k) -> const Eigen::Quaterniond& { return turns[first_[k] / 3]; };
  for (std::size_t k = 0; k < size; ++k) {
    scratch.segment<3>(3 * k) = turn(k).conjugate() * Eigen::Vector3d(force_N.segment<3>(first_[k]));
  }
  for (std::size_t k = 0; k < size; ++k) {
    const Eigen::Vector3d here = scratch.segment<3>(3 * k);
    for (std::size_t b = begin_[k]; b < begin_[k + 1]; ++b) scratch.segment<3>(row_[b]) -= blocks_[b] * here;
  }
  for (std::size_t k = size; k-- > 0;) {
    Eigen::Vector3d here = yields_[k] * scratch.segment<3>(3 * k);
    for (std::size_t b = begin_[k]; b < begin_[k + 1]; ++b) {
      here -= blocks_[b].transpose() * scratch.segment<3>(row_[b]);
    }
    scratch.segment<3>(3 * k) = here;
    moved_m.segment<3>(first_[k]) = turn(k) * here;
  }
}

// The rows from one on, where those before have no forces and are not wanted.
void StiffnessFactors::solve_from(std::size_t from, Panel& panel) const {
  Eigen::Matrix<double, 3, Panel::ColsAtCompileTime, Eigen::RowMajor> here;
  for (std::size_t k = from; k < first_.size(); ++k) {
    here = panel.middleRows<3>(3 * k);
    for (std::size_t b = begin_[k]; b < begin_[k + 1]; ++b) {
      panel.middleRows<3>(row_[b]).noalias() -= blocks_[b].lazyProduct(here);
    }
  }
  for (std::size_t k = first_.size(); k-- > from;) {
    here.noalias() = yields_[k].lazyProduct(panel.middleRows<3>(3 * k));
    for (std::size_t b = begin_[k]; b < begin_[k + 1]; ++b) {
      here.noalias() -= blocks_[b].transpose().lazyProduct(panel.middleRows<3>(row_[b]));
    }
    panel.middleRows<3>(3 * k) = here;
  }
}

Eigen::MatrixXd StiffnessFactors::compliance_m_per_N(const std::vector<int>& nodes) const {
  struct Wanted {
    std::size_t place;  // in the factors' order
    Eigen::Index row;
  };
  std::map<Eigen::Index, std::size_t> places;
  for (std::size_t k = 0; k < first_.size(); ++k) places.emplace(first_[k], k);
  std::vector<Wanted> wanted;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto free = places.find(3 * static_cast<Eigen::Index>(nodes[n]));
    if (free != places.end()) wanted.push_back({free->second, 3 * static_cast<Eigen::Index>(n)});
  }
  std::ranges::sort(wanted, {}, &Wanted::place);
  const auto size = 3 * static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(size, size);
  Panel panel(3 * first_.size(), Panel::ColsAtCompileTime);
  constexpr std::size_t kAtOnce = Panel::ColsAtCompileTime / 3;
  for (std::size_t from = 0; from < wanted.size(); from += kAtOnce) {
    const std::size_t end = std::min(from + kAtOnce, wanted.size());
    panel.setZero();
    for (std::size_t n = from; n < end; ++n) panel.block<3, 3>(3 * wanted[n].place, 3 * (n - from)).setIdentity();
    solve_from(wanted[from].place, panel);
    for (std::size_t column = from; column < end; ++column) {
      for (std::size_t row = column; row < wanted.size(); ++row) {
        const Eigen::Matrix3d moved = panel.block<3, 3>(3 * wanted[row].place, 3 * (column - from));
        compliance.block<3, 3>(wanted[row].row, wanted[column].row) = moved;
        compliance.block<3, 3>(wanted[column].row, wanted[row].row) = moved.transpose();
        if (row == column) compliance.block<3, 3>(wanted[row].row, wanted[row].row) = 0.5 * (moved + moved.transpose());
      }
    }
  }
  return compliance;
}

std::size_t StiffnessFactors::memory_bytes() const noexcept {
  return (yields_.size() + blocks_.size()) * sizeof(Eigen::Matrix3d) +
         (first_.size() + row_.size()) * sizeof(Eigen::Index) + begin_.size() * sizeof(std::size_t);
}

}  // namespace forcebound::tissue
