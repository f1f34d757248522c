#pragma once

#include "forcebound/control/device_facts.hpp"

namespace forcebound::test {

/// A Cartesian device at 1 kHz whose readings and forces have no steps, without friction, up to 30 N.
inline control::DeviceFacts ideal_device(const control::Matrix& damping) {
  control::DeviceFacts facts;
  facts.name = "ideal";
  facts.damping = damping;
  facts.friction = facts.encoder_step = facts.actuator_step = control::Vector::Zero(damping.rows());
  facts.force_N_max = 30;
  return facts;
}

/// With the damping of the paper's, 30 N s/m on each axis.
inline control::DeviceFacts ideal_device(int degrees_of_freedom) {
  return ideal_device(30 * control::Matrix::Identity(degrees_of_freedom, degrees_of_freedom));
}

}  // namespace forcebound::test
