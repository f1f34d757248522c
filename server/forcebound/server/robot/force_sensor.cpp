#include "forcebound/server/robot/force_sensor.hpp"

namespace forcebound::server {

ForceSensor::ForceSensor(const ForceSensorFacts& facts, std::uint64_t seed) : facts_(facts), random_(seed) {
  std::uniform_real_distribution<double> share(-1, 1);
  for (double& axis : bias_.head<3>()) axis = facts.bias_N_max * share(random_);
  for (double& axis : bias_.tail<3>()) axis = facts.bias_N_m_max * share(random_);
}

void ForceSensor::pass(Nanoseconds now, const Vector6& wrench) noexcept {
  if (now < next_) return;
  const Nanoseconds sampled = now / facts_.period * facts_.period;
  next_ = sampled + facts_.period;
  const Eigen::Vector3d force = wrench.head<3>() + bias_.head<3>() + noise(facts_.noise_N_sd);
  const Eigen::Vector3d torque = wrench.tail<3>() + bias_.tail<3>() + noise(facts_.noise_N_m_sd);
  newest_ = SensedForce{.force_N = force, .torque_N_m = torque, .sampled = sampled};
}

Eigen::Vector3d ForceSensor::noise(double sd) noexcept {
  const double x = normal_(random_);
  const double y = normal_(random_);
  const double z = normal_(random_);
  return sd * Eigen::Vector3d(x, y, z);
}

}  // namespace forcebound::server
