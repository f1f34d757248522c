#pragma once

#include <string>

#include "tests/tools/lab/soak/soak_tip.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// One hostile run: everything drawn from its seed.
struct SoakCase {
  std::uint64_t seed = 1;
  sim::ClosedLoop::Settings settings;
  time::Nanoseconds duration{0};
  time::Nanoseconds last_fault{0};  ///< when the last fault is over
  std::string environment;
  std::string network_up;
  std::string network_down;
  bool pieces_changed = false;  ///< of the scene, on their way to the client
  bool models_lie = false;      ///< each answer has local models that a lying server made up
  bool passive = false;         ///< the law guarantees P >= 0 with this device and this clock
  bool beyond_bounds = false;   ///< the device's truth lies outside its facts' bounds, so that nothing is guaranteed
  bool shortens = false;        ///< the law guarantees that the force is the request, shortened

  /// Every setting, a line each.
  [[nodiscard]] std::string description() const;
};

/// Device and how far it is from its facts, encoder, actuator, friction, latency, hold time, tick timing, law's memory,
/// environment, hand, network, faults, the server's clock, and where the forces are computed, all from the seed; the
/// law is the caller's, so that the same seeds test all laws. A law with guarantees for an ideal device only gets one
/// with half of the seeds; one that refuses the device gets another.
/// @throws std::invalid_argument for an unknown law, and with a tool for one that refuses a device of six axes
[[nodiscard]] SoakCase draw_soak_case(std::uint64_t seed, const std::string& law, SoakTip tip = SoakTip::point);

}  // namespace forcebound::lab
