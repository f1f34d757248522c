#include "forcebound/server/dynamics/bodies/apparent_mass.hpp"

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <limits>

namespace forcebound::server {

double apparent_mass_kg(const mjModel_& model, mjData_& data, const std::vector<int>& bodies) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Rows jacobian(3 * bodies.size(), model.nv);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    mj_jacBodyCom(&model, &data, jacobian.row(static_cast<Eigen::Index>(3 * i)).data(), nullptr, bodies[i]);
  }
  Rows motion_per_N(jacobian.rows(), jacobian.cols());
  mj_solveM(&model, &data, motion_per_N.data(), jacobian.data(), static_cast<int>(jacobian.rows()));
  const Eigen::MatrixXd mobility_per_kg = jacobian * motion_per_N.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> mobilities(mobility_per_kg, Eigen::EigenvaluesOnly);
  const double most_per_kg = mobilities.eigenvalues().maxCoeff();
  // A hinge through the centre of mass leaves only rounding.
  constexpr double kNone_per_kg = 1e-12;
  return most_per_kg > kNone_per_kg ? 1 / most_per_kg : std::numeric_limits<double>::infinity();
}

}  // namespace forcebound::server
