#pragma once

#include <string_view>

#include "forcebound/control/law_description.hpp"

/// The paper's wall for any law, without a network: displayed stiffness and returned energy of a contact.
namespace forcebound::test {

/// A hand leads the paper's device [Kim 2015, section VI] into a wall at x >= 0 and holds; it may go back:
///
///     hand =(k_h, b_h)= device (0.1 kg, 30 N s/m) -- law --(late by some ticks)-- wall
struct PressedWall {
  std::string_view law;
  control::LawParameters parameters{};
  double stiffness_N_per_m = 150e3;
  int late_ticks = 0;  ///< the force of a tick answers the motion this many ticks before
  double hand_N_per_m = 500;
  double encoder_m = 0;   ///< distance of two readings; 0: ideal
  bool retreats = false;  ///< after two of the three seconds
};

struct PressedWallResult {
  double shown_N_per_m = 0;  ///< mean force over mean depth in the last 0.3 s of holding
  double ripple_N = 0;       ///< largest less smallest force in that time
  double least_P_J = 0;      ///< of the audit, to a microjoule
  double stored_J = 0;       ///< absorbed by the force
  double returned_J = 0;     ///< returned by it; both over the whole run
};

[[nodiscard]] PressedWallResult press(const PressedWall& setting);

/// On a wall of 80 N/mm, too stiff for the device without a law, the force ripples less than half as much as without
/// one, and less than a hundredth of the energy is generated (least P).
void expect_calms_a_wall_too_stiff(std::string_view law);

}  // namespace forcebound::test
