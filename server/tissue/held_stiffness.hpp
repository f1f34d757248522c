#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <string>

namespace forcebound::server {

using SparseCholesky = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

/// Factorises the stiffness of a body's free coordinates.
/// @param name of the body, for messages. @throws std::runtime_error unless the held ones keep it in its place.
void factorise(SparseCholesky& cholesky, const Eigen::SparseMatrix<double>& stiffness, const std::string& name);

}  // namespace forcebound::server
