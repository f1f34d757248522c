#pragma once

#include <vector>

/// The published force bounding laws in a hundred decimal digits and the paper's own variables: the reference for the
/// laws of common/control. Shares no code with them, not even a matrix type.
namespace forcebound::test {

struct ReferenceTick {
  std::vector<double> position_m;
  std::vector<double> request_N;                       ///< before saturation
  std::vector<std::vector<double>> damping_N_s_per_m;  ///< at this reading: holds for the interval that begins here
};

struct ReferenceAnswer {
  std::vector<double> force_N;
  double energy_J = 0;  ///< E_n or A_n, after the tick's motion
  double xi = 1;        ///< after the tick's force
};

struct ReferenceSetting {
  double period_s = 1e-3;
  double force_N_max = 0;  ///< 0: no saturation
};

/// fba-less [Kim 2015, Prop. 1, eq. 17-21]; the paper's F_d is -force_N.
std::vector<ReferenceAnswer> less_conservative_reference(const std::vector<ReferenceTick>& ticks,
                                                         const ReferenceSetting& setting);

/// fba-more [Kim 2015, Prop. 3, eq. 24-34], by Phi and xi, which it divides by: with a hundred digits, the exponent
/// does not underflow.
std::vector<ReferenceAnswer> more_conservative_reference(const std::vector<ReferenceTick>& ticks,
                                                         const ReferenceSetting& setting);

}  // namespace forcebound::test
