#include "forcebound/control/held_force.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/control/classic_text.hpp"

namespace forcebound::control {

HeldForce::HeldForce(int degrees_of_freedom, double period_s) : period_s_(period_s) {
  if (degrees_of_freedom < 1 || degrees_of_freedom > kJointsMax) {
    throw std::invalid_argument("degrees of freedom must be 1 to " + std::to_string(kJointsMax) + ", got " +
                                std::to_string(degrees_of_freedom));
  }
  if (!(period_s > 0) || !std::isfinite(period_s)) {
    throw std::invalid_argument(joined("period must be > 0 s, got ", period_s));
  }
  force_ = Vector::Zero(degrees_of_freedom);
}

double HeldForce::worst_case_J(double interval_s) const noexcept {
  const bool longer = is_measurable(interval_s) && interval_s > period_s_;
  return reserve_J(force_) * (longer ? interval_s / period_s_ : 1.0);
}

bool HeldForce::affords(const Vector& force_N, double energy_J) const noexcept {
  constexpr double kRounding = 1e-12;
  return force_N.isZero(0) || reserve_J(force_N) <= energy_J * (1 + kRounding);
}

Vector HeldForce::bounded(const Vector& request_N, double energy_J) const noexcept {
  const double largest = request_N.lpNorm<Eigen::Infinity>();
  if (!(largest > 0) || !(energy_J > 0) || !known()) return Vector::Zero(request_N.rows());
  // Through its largest component, so that neither 1e300 N nor 1e-300 N leaves the range of a double when squared.
  const Vector direction = request_N / largest;
  const double largest_allowed = std::sqrt(energy_J / reserve_J(direction));
  if (largest <= largest_allowed) return request_N;
  return direction * largest_allowed;
}

}  // namespace forcebound::control
