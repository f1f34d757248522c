#pragma once

#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/held_force.hpp"

namespace forcebound::control {

/// The energy balance of device and force since the start [Kim 2015, eq. 21]; our f is the paper's -F_d:
///
///     E_n = E_{n-1} + d'B d - f_{n-1}'d,   E_0 = 0
///
/// Never reset. An interval whose end was not read, or that no clock can have measured, credits nothing and is
/// charged the worst that its force can have done.
/// Real time: noexcept, no allocation, O(dof^2).
class Ledger {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 7 and period [s] > 0.
  Ledger(int degrees_of_freedom, double period_s) : held_(degrees_of_freedom, period_s) {}

  void credit(const Motion& motion) noexcept;
  void lose(double interval_s) noexcept;
  void hold(const Vector& force_N) noexcept { held_.hold(force_N); }

  [[nodiscard]] double energy_J() const noexcept { return energy_.value_J(); }
  [[nodiscard]] const HeldForce& held() const noexcept { return held_; }

 private:
  HeldForce held_;
  EnergySum energy_;
};

}  // namespace forcebound::control
