#pragma once

#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// The newest that is known of the device that leads a robot.
struct LeaderMotion {
  Vector position{};  ///< of its tip [m], its own frame, 1 to 3 rows; finite
  control::Handle handle{};
  double energy_given_J = 0;  ///< by the law at the device, since it began
  Nanoseconds arrived{0};     ///< server's clock
};

}  // namespace forcebound::server
