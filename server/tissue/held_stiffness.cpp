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

}  // namespace forcebound::server
