#include "forcebound/local_model/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace forcebound::local_model {

Eigen::Vector3d eigenvalues(const Eigen::Matrix3d& symmetric) noexcept {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace forcebound::local_model
