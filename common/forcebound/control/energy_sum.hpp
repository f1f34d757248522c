#pragma once

#include <cmath>
#include <limits>

#include "forcebound/control/assertion.hpp"

namespace forcebound::control {

/// A running sum of energies [J] that does not forget small terms beside large ones (Neumaier's compensated sum).
///
/// A day at 1 kHz is 1e8 terms of nanojoules beside a total of joules; plain addition would lose them. A sum
/// beyond the largest double stays at the largest double. Real time: noexcept, no allocation,
/// O(1).
class EnergySum {
 public:
  void add(double energy_J) noexcept {
    FORCEBOUND_ASSERT(!std::isnan(energy_J), "energy is a number, so that the ledger stays one");
    const double sum = sum_ + energy_J;
    if (std::isinf(sum)) {
      sum_ = std::copysign(std::numeric_limits<double>::max(), sum);
      compensation_ = 0;
      return;
    }
    compensation_ += std::abs(sum_) >= std::abs(energy_J) ? (sum_ - sum) + energy_J : (energy_J - sum) + sum_;
    sum_ = sum;
  }

  [[nodiscard]] double value_J() const noexcept {
    const double value = sum_ + compensation_;
    return std::isinf(value) ? sum_ : value;
  }

 private:
  double sum_ = 0;
  double compensation_ = 0;
};

}  // namespace forcebound::control
