#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/tools/lab/teleoperation/impedance_study.hpp"
#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"

namespace forcebound::lab {

inline constexpr std::array kFreeSwings_m{5e-3, 50e-3};
inline constexpr std::array kLeaderSpeeds_m_per_s{0.01, 0.03, 0.1};

/// Wanted of free space, through up to kNearby_s each way: what is felt up to kSlow_Hz, and the lag.
inline constexpr double kFeltMost_N_s_per_m = 5;
inline constexpr double kSlow_Hz = 5;
inline constexpr double kLagMost_m = 5e-3;
inline constexpr double kNearby_s = 0.05;

/// What there is of a robot where it touches nothing.
struct FreeSpaceRow {
  std::string architecture;
  std::string law;
  std::string network;
  double delay_s = 0;  ///< from the leader to the robot
  /// Of each swing and frequency, size of the force on the hand over that of its speed, at that frequency and in
  /// whatever phase: of a damper or a spring. The device's own is not in it.
  std::array<std::array<double, kSwings_Hz.size()>, kFreeSwings_m.size()> felt_N_s_per_m{};
  /// At each speed, most of the way from the tool to its leader, less delay times speed.
  std::array<double, kLeaderSpeeds_m_per_s.size()> lag_m{};
  double least_P_J = 0;  ///< of both sides and all runs
};

/// No network; 20, 50, 100 and 400 ms each way.
[[nodiscard]] std::vector<NamedNetwork> free_space_networks();

/// Each architecture with each law through each network.
/// @throws std::invalid_argument for a recorded network, whose delay is not known
/// @throws std::runtime_error if the tool touches something, as with a large motion scale
[[nodiscard]] std::vector<FreeSpaceRow> study_free_space(const TeleoperationStudy& study);

[[nodiscard]] std::string free_space_text(const std::vector<FreeSpaceRow>& rows);

}  // namespace forcebound::lab
