#include "forcebound/baselines/device_limits.hpp"

#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <string>

namespace forcebound::baselines {

double least_damping(const control::DeviceFacts& facts) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(facts.damping, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

double slowest_reading_m_per_s(const control::DeviceFacts& facts) {
  if (!facts.cartesian || facts.encoder_step.size() == 0) return 0;
  return 0.5 * facts.encoder_step.minCoeff() / facts.period_s;
}

void require_constant_translations(std::string_view law, const control::DeviceFacts& facts) {
  constexpr int kTranslations = 3;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("law '" + std::string(law) + "' has one gain for all axes and poses, but device '" +
                                facts.name + "' " + why);
  };
  if (!facts.cartesian) refuse("is an arm whose damping depends on its pose; a Cartesian device is wanted");
  if (facts.degrees_of_freedom() > kTranslations) {
    refuse("turns as well: " + std::to_string(facts.degrees_of_freedom()) + " degrees of freedom, 1 to 3 are wanted");
  }
}

void require_translations(std::string_view law, const control::DeviceFacts& facts) {
  if (facts.rotations == 0) return;
  throw std::invalid_argument("law '" + std::string(law) + "' adds up all axes, but device '" + facts.name +
                              "' turns as well; a device that shows no torque is wanted");
}

}  // namespace forcebound::baselines
