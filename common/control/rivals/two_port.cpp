#include "forcebound/control/rivals/two_port.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace forcebound::control {

double RemoteSum::hear(double sum) noexcept {
  if (!largest_) {
    largest_ = sum;
    return 0;
  }
  if (!(sum > *largest_)) return 0;
  // From the least to the largest number is further than a number can be.
  const double news = std::min(sum - *largest_, std::numeric_limits<double>::max());
  largest_ = sum;
  return news;
}

EndedInterval next_interval(HeldForce& held, const Motion& motion) noexcept {
  const Eigen::Index dof = held.force().rows();
  EndedInterval ended{
      .displacement = Vector::Zero(dof), .velocity = Vector::Zero(dof), .force = Vector::Zero(dof), .unseen_J = 0};
  const bool measurable = is_measurable(motion.interval_s);
  const bool seen = measurable && motion.held_s >= motion.interval_s;
  if (!seen) {
    ended.unseen_J = held.worst_case_J(measurable ? motion.held_s : motion.interval_s);
    held.lose();
  }
  const auto d = held.displacement(motion);
  if (d && (*d / motion.interval_s).allFinite()) {
    ended.displacement = *d;
    ended.velocity = *d / motion.interval_s;
    ended.force = held.force();
    ended.interval_s = motion.interval_s;
  }
  held.begin(motion);
  return ended;
}

Vector no_longer_than(const Vector& force_N, double most_N) noexcept {
  const double length = force_N.stableNorm();
  if (!std::isfinite(length)) return Vector::Zero(force_N.rows());
  return length > most_N ? Vector(force_N * (most_N / length)) : force_N;
}

Vector keeping_back(const Vector& displacement, const Vector& force_N, double kept_back_J) noexcept {
  const double length = force_N.stableNorm();
  if (!(kept_back_J > 0) || !(length > 0)) return displacement;
  return displacement + force_N / length * (kept_back_J / length);
}

double least_damping(const DeviceFacts& facts) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(facts.damping, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

void require_constant_translations(std::string_view law, const DeviceFacts& facts) {
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

}  // namespace forcebound::control
