#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"

namespace forcebound::lab {

/// What a hand that swings at one frequency meets: force against the hand over its velocity, at that frequency.
struct TransmittedImpedance {
  double frequency_Hz = 0;
  std::complex<double> N_s_per_m{};
};

/// How a hand swings: about a place that it goes to first, from where the tool starts; robot's world.
struct Swing {
  Eigen::Vector3d place_m{Eigen::Vector3d::Zero()};
  Eigen::Vector3d way{Eigen::Vector3d::UnitX()};  ///< unit
  double size_m = 5e-3;                           ///< to each side
  double frequency_Hz = 1;
};

/// What it meets, once settled, and the run's measures.
struct SwingOutcome {
  TransmittedImpedance met{};
  TeleoperationMeasures measures{};
};

/// @param setup all but the hand and the time
[[nodiscard]] SwingOutcome swing_hand(TeleoperationSetup setup, const Swing& swing);

/// Of both studies.
inline constexpr std::array kSwings_Hz{0.5, 1.0, 2.0, 5.0, 10.0, 20.0};

struct ImpedanceRow {
  std::string architecture;
  std::string network;
  bool in_contact = false;
  std::vector<TransmittedImpedance> at{};
  double least_P_J = 0;  ///< of both sides and all frequencies
};

/// 0.5 to 20 Hz, with 5 mm in free space and 1 mm in contact with the stiff wall, which the hand presses meanwhile.
/// With the first of the laws.
[[nodiscard]] std::vector<ImpedanceRow> study_impedance(const TeleoperationStudy& study);

[[nodiscard]] std::string impedance_text(const std::vector<ImpedanceRow>& rows, double wall_N_per_m);

}  // namespace forcebound::lab
