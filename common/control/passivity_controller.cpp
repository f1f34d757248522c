#include "forcebound/control/passivity_controller.hpp"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace forcebound::control {
namespace {

Vector rounded_toward_zero(Vector command, const Vector& step) noexcept {
  for (Eigen::Index i = 0; i < command.rows(); ++i) {
    if (step[i] > 0) command[i] = std::trunc(command[i] / step[i]) * step[i];
  }
  return command;
}

}  // namespace

PassivityController::PassivityController(const DeviceFacts& facts, std::unique_ptr<PassivityLaw> law)
    : law_(std::move(law)),
      actuator_step_(facts.actuator_step),
      cartesian_(facts.cartesian),
      force_N_max_(facts.force_N_max) {
  if (!law_) throw std::invalid_argument("a passivity controller needs a law");
  if (actuator_step_.rows() != facts.degrees_of_freedom()) {
    throw std::invalid_argument("device '" + facts.name + "': actuator step must have " +
                                std::to_string(facts.degrees_of_freedom()) + " rows, got " +
                                std::to_string(actuator_step_.rows()));
  }
}

Vector PassivityController::tick(const Motion& motion, const Vector& request_N) noexcept {
  if (!motion.position.allFinite() || !motion.jacobian.allFinite()) {
    ++counts_.readings_not_finite;
    law_->charge_worst_case(motion.interval_s);
    return Vector::Zero(actuator_step_.rows());
  }
  law_->credit(motion);
  const Vector force = rounded(law_->bound(saturated(request_N)), motion.jacobian);
  law_->commit(force);
  return force;
}

Vector PassivityController::saturated(const Vector& request_N) noexcept {
  if (request_N.rows() != actuator_step_.rows() || !request_N.allFinite()) {
    ++counts_.requests_not_finite;
    return Vector::Zero(actuator_step_.rows());
  }
  const double length = request_N.stableNorm();
  if (length <= force_N_max_) return request_N;
  ++counts_.saturated;
  return request_N / length * force_N_max_;
}

Vector PassivityController::rounded(const Vector& force_N, const Matrix& jacobian) const noexcept {
  if (actuator_step_.isZero(0)) return force_N;
  Vector force = cartesian_ ? rounded_toward_zero(force_N, actuator_step_)
                            : Vector(jacobian.transpose().partialPivLu().solve(
                                  rounded_toward_zero(jacobian.transpose() * force_N, actuator_step_)));
  if (!force.allFinite() || !law_->allows(force)) force.setZero();
  return force;
}

}  // namespace forcebound::control
