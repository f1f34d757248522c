#pragma once

#include <array>

#include "forcebound/local_model/device_point.hpp"
#include "forcebound/local_model/local_model.hpp"

namespace forcebound::local_model {

/// Where a Mass is, and what it meets.
struct MassState {
  /// What is met, since it was told of.
  struct Met {
    double gap_m = 0;  ///< infinite once it went below where the contact ends
    Point moved_m = Point::Zero();
    Point velocity_m_per_s = Point::Zero();
    // Impulses of the last step, with which the next one begins: by the contact along its normal and beside it, by dry
    // friction, and by what stops the body met, along the normal [N s].
    double pressed_Ns = 0;
    Point rubbed_Ns = Point::Zero();
    Point dry_Ns = Point::Zero();
    double stopped_Ns = 0;
    Point received_Ns = Point::Zero();  ///< impulse of the contact on what is met, of all steps together
  };

  Point place_m = Point::Zero();
  Point velocity_m_per_s = Point::Zero();
  Point dry_Ns = Point::Zero();  ///< impulse of dry friction in the last step
  std::array<Met, Mass::kContactsMax> met{};
};

/// As it was told.
[[nodiscard]] MassState state_of(const Mass& told) noexcept;

/// Of the coupling on the mass.
[[nodiscard]] Point pull_N(const Mass& mass, const MassState& state, const DevicePoint& device) noexcept;

/// Moves it by a step. Springs and dampers are taken at the step's end: whatever their numbers and the step are, it
/// stays stable, and those of the coupling and of joints give back no more than they took. What contacts and dry
/// friction have to do together is found by a fixed number of projected Gauss-Seidel sweeps, which begin with the last
/// step's impulses.
///
/// @param device at the step's end
/// @param share of what else pulls: less than 1 when the server does not say so any more
/// Real time: noexcept, no allocation.
void step(const Mass& mass, const DevicePoint& device, double step_s, double share, MassState& state) noexcept;

}  // namespace forcebound::local_model
