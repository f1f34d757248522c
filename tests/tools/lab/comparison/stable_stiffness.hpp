#pragma once

#include <functional>
#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"

namespace forcebound::lab {

/// The largest stiffness below which everything is stable, as far as it was tried.
struct StableStiffness {
  double N_per_m = 0;     ///< 0: even the least is unstable
  bool no_limit = false;  ///< all values tried are stable: this is the largest tried
};

/// Doubles from `least` to the first unstable value, then bisects to `resolution`, relative.
struct StiffnessSearch {
  double least_N_per_m = 100;
  double most_N_per_m = 1e6;
  double resolution = 0.02;
};
[[nodiscard]] StableStiffness largest_stable(const StiffnessSearch& search,
                                             const std::function<bool(double N_per_m)>& stable);

/// Hands that press into a wall: whether a wall rings depends on the hand.
struct PressingHand {
  std::string name;
  std::string specification;  ///< of the operator
};
[[nodiscard]] const std::vector<PressingHand>& pressing_hands();

/// A wall behind a network that delays each way by `delay_s`.
struct PressedWall {
  std::string law;
  std::string hand;  ///< the operator's specification
  control::LawParameters parameters{};
  std::string device = "wall-1dof";
  double delay_s = 0;
  double rate_Hz = 0;  ///< ticks per second; 0: the device's own
};

/// Whether the contact comes to rest; ideal encoder, clock and latency.
[[nodiscard]] bool is_stable(const PressedWall& wall, double stiffness_N_per_m);

/// Whether the device alone, released on a two-sided spring, comes to rest without any law; ideal as well.
[[nodiscard]] bool free_device_is_stable(const std::string& device, double stiffness_N_per_m);

/// Theoretical limits for a device of mass m and damping b along its first axis, sampled every T, behind a delay t_d
/// each way.
struct TheoryLimits {
  double passive_N_per_m;  ///< 2b/T: no hand makes it ring [Colgate 1994]
  double delayed_N_per_m;  ///< b/(T/2 + 2 t_d): the force is late by both ways
  double free_N_per_m;     ///< (1 - e^-a)/((m/b^2)(1 - e^-a) - (T/b) e^-a), a = bT/m: the device alone, no delay
};
/// @param rate_Hz ticks per second; 0: the device's own
/// @throws std::invalid_argument unless the device is Cartesian with axes that are independent of one another
[[nodiscard]] TheoryLimits theory_limits(const std::string& device, double delay_s, double rate_Hz = 0);

}  // namespace forcebound::lab
