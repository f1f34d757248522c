#include "forcebound/server/follower/initial_energy.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace forcebound::server {

double largest_initial_J(const RobotModel& model) {
  const double speed_m_per_s = model.limits().tool_speed_m_per_s_max;
  if (!(speed_m_per_s > 0)) return 0;
  const Vector& posture = model.rest();
  const Eigen::MatrixXd jacobian = model.jacobian(posture).topRows<3>();
  const Eigen::MatrixXd mass = model.mass_matrix(posture);
  const Eigen::Matrix3d mobility = jacobian * mass.llt().solve(jacobian.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(0.5 * (mobility + mobility.transpose()),
                                                             Eigen::EigenvaluesOnly);
  const double largest_per_kg = eigen.eigenvalues()[2];
  return largest_per_kg > 0 ? 0.5 * speed_m_per_s * speed_m_per_s / largest_per_kg : 0;
}

}  // namespace forcebound::server
