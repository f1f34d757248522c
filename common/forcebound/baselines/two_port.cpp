#include "forcebound/baselines/two_port.hpp"

#include <algorithm>
#include <limits>

namespace forcebound::baselines {

double RemoteSum::receive(double sum) noexcept {
  if (!largest_) {
    largest_ = sum;
    return 0;
  }
  if (!(sum > *largest_)) return 0;
  // The difference of two finite numbers may overflow.
  const double news = std::min(sum - *largest_, std::numeric_limits<double>::max());
  largest_ = sum;
  return news;
}

EndedInterval next_interval(control::HeldForce& held, const control::Motion& motion) noexcept {
  const Eigen::Index dof = held.force().rows();
  EndedInterval ended{
      .displacement = Vector::Zero(dof), .velocity = Vector::Zero(dof), .force = Vector::Zero(dof), .unseen_J = 0};
  const bool measurable = control::is_measurable(motion.interval_s);
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

Vector keeping_back(const Vector& displacement, const Vector& force_N, double kept_back_J) noexcept {
  const double length = force_N.stableNorm();
  if (!(kept_back_J > 0) || !(length > 0)) return displacement;
  return displacement + force_N / length * (kept_back_J / length);
}

}  // namespace forcebound::baselines
