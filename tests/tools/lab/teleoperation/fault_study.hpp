#pragma once

#include <string>
#include <vector>

#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"

namespace forcebound::lab {

/// What both ends do when something fails while the tool presses on the wall.
struct FaultRow {
  std::string fault;
  double holding_s = 0;      ///< after the fault until the robot holds its place; not a number: it did not
  double stopping_s = 0;     ///< until it is being stopped
  double stopped_s = 0;      ///< until it is at rest
  double hand_free_s = 0;    ///< until the hand feels less than 0.1 N
  double following_s = 0;    ///< after the end of the fault until it follows again
  double step_N_per_ms = 0;  ///< largest change of the force on the hand within a millisecond, from the fault on
  double speed_m_per_s = 0;  ///< largest speed of the tool from the fault on
  double contact_N_max = 0;  ///< largest contact force from the fault on
  double leader_minimum_J = 0;
  double follower_minimum_J = 0;
};

/// Client, server and network fail, the robot is unplugged, and its torques are too small for what is asked.
[[nodiscard]] std::vector<FaultRow> study_faults(const TeleoperationStudy& study);

[[nodiscard]] std::string fault_text(const std::vector<FaultRow>& rows);

}  // namespace forcebound::lab
