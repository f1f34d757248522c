#include "forcebound/control/more_conservative_law.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::control {

MoreConservativeLaw::MoreConservativeLaw(int degrees_of_freedom, double period_s)
    : held_(degrees_of_freedom, period_s) {}

void MoreConservativeLaw::credit(const Motion& motion) noexcept {
  // A clock that stands still, runs back or jumps out of range says nothing of how long the force was held. Where the
  // device was when it zeroed the force, no reading tells.
  if (!is_measurable(motion.interval_s)) {
    lose_for(motion.interval_s);
  } else if (motion.held_s < motion.interval_s) {
    lose_for(motion.held_s);
  }
  available_J_ = 0;
  if (const auto d = held_.displacement(motion)) {
    Vector psi = std::sqrt(xi_ / held_.period_s()) * held_.damping().factor_transpose_times(*d);
    if (reserved_J_ > 0) {
      const Vector w = held_.damping().factor_solve(held_.force() / held_.force().lpNorm<Eigen::Infinity>());
      psi -= std::sqrt(reserved_J_) / w.norm() * w;
    }
    // A reading as far away as a double can hold is a fault, not energy.
    const double available_J = psi.squaredNorm();
    available_J_ = std::isfinite(available_J) ? available_J : 0;
    const double repaid_J = std::min(debt_J_, available_J_);
    debt_J_ -= repaid_J;
    available_J_ -= repaid_J;
  }
  held_.begin(motion);
}

void MoreConservativeLaw::lose_for(double interval_s) noexcept {
  // The reserve is just what the worst motion takes in one period; beyond it, what a longer hold took is owed.
  debt_J_ += std::max(0.0, held_.worst_case_J(interval_s) - reserved_J_);
  available_J_ = 0;
  reserved_J_ = 0;
  xi_ = 1;
  held_.lose();
}

Vector MoreConservativeLaw::bound(const Vector& request_N) noexcept { return held_.bounded(request_N, available_J_); }

bool MoreConservativeLaw::allows(const Vector& force_N, double /*latency_s*/) const noexcept {
  return held_.affords(force_N, available_J_);
}

void MoreConservativeLaw::commit(const Vector& force_N) noexcept {
  held_.hold(force_N);
  const double needed_J = held_.reserve_J(force_N);
  const bool forget = force_N.isZero(0) || !(available_J_ > 0);
  reserved_J_ = forget ? 0 : available_J_;
  xi_ = !forget && needed_J < available_J_ ? needed_J / available_J_ : 1;
}

}  // namespace forcebound::control
