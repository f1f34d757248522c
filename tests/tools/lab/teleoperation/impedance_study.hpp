#pragma once

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
