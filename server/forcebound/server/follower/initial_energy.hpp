#pragma once

#include "forcebound/server/robot/robot_model.hpp"

namespace forcebound::server {

/// The most energy E_0 that a robot's law may begin with [J]: the kinetic energy of the robot's own mass where its tool
/// moves at its speed limit v, in the direction in which the tool is lightest, at the model's rest posture:
///
///     E_0 <= v^2 / (2 sigma),    sigma the largest eigenvalue of J M^-1 J', J of the tool's point     [Khatib 1987]
///
/// A robot that may move so fast can deliver that at an impact whatever its law does: a store of it adds no hazard.
/// 0 where the model states no speed limit.
[[nodiscard]] double largest_initial_J(const RobotModel& model);

}  // namespace forcebound::server
