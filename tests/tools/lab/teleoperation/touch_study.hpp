#pragma once

#include <string>
#include <vector>

#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"

namespace forcebound::lab {

/// One touch of a wall, as the hand feels it.
struct Touch {
  bool felt = false;
  double felt_after_s = 0;       ///< from where the hand's place crosses the wall until it feels 0.5 N
  double depth_when_felt_m = 0;  ///< how deep the hand was then
  double most_N_per_ms = 0;      ///< largest change of the force on the hand within a millisecond
  double displayed_N_per_m = 0;  ///< force over depth below the true wall, at rest; not a number: not at rest there
};

/// Two touches of the same wall: unknown, then known. Then the hand slides along it.
struct TouchRow {
  std::string architecture;  ///< "no network, no robot": the same device at a virtual wall
  std::string network;
  Touch first{};
  Touch second{};
  double displayed_friction = 0;  ///< force along the wall over that out of it, as the hand slides; or not a number
  double leader_minimum_J = 0;
  double follower_minimum_J = 0;
};

/// The task's wall, pressed twice with 40 mm/s and rubbed with 15 mm/s, by each architecture through each network; and
/// first the same hand and device at a virtual wall of that stiffness and friction, without any network.
/// @throws as study_teleoperation
[[nodiscard]] std::vector<TouchRow> study_touches(const TeleoperationStudy& study);

[[nodiscard]] std::string touch_text(const std::vector<TouchRow>& rows);

}  // namespace forcebound::lab
