#pragma once

#include "forcebound/control/device_facts.hpp"

namespace forcebound::test {

/// The damping and the period of the paper's device, and b / T.
inline constexpr double kDamping_N_s_per_m = 30;
inline constexpr double kPeriod_s = 1e-3;
inline constexpr double kB_N_per_m = kDamping_N_s_per_m / kPeriod_s;

/// A Cartesian device at 1 kHz whose readings and forces have no steps, without friction, up to 30 N.
inline control::DeviceFacts ideal_device(const control::Matrix& damping) {
  control::DeviceFacts facts;
  facts.name = "ideal";
  facts.damping = damping;
  facts.friction = facts.encoder_step = facts.actuator_step = control::Vector::Zero(damping.rows());
  facts.force_N_max = 30;
  return facts;
}

/// With the damping of the paper's on each axis.
inline control::DeviceFacts ideal_device(int degrees_of_freedom) {
  return ideal_device(kDamping_N_s_per_m * control::Matrix::Identity(degrees_of_freedom, degrees_of_freedom));
}

}  // namespace forcebound::test
