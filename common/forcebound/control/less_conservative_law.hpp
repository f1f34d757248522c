#pragma once

#include "forcebound/control/law.hpp"
#include "forcebound/control/ledger.hpp"

namespace forcebound::control {

/// The less conservative force bounding law: spends all energy that was ever saved.
///
/// Vectors have `dof` rows in the device frame: position [m], force on the device [N]; B = b/T.
///
///     E_n = E_{n-1} + d'B d - f_{n-1}'d                    [Kim 2015, Prop. 1, eq. 9, 21; our f is the paper's -F_d]
///     f_n = u min(|f_e|, sqrt(4 max(E_n, 0) / u'B^-1 u))   [eq. 17-20]
///
/// Passive where readings are exact, ticks punctual and forces immediate; what it leaks elsewhere is what the audit of
/// a simulated device shows. B uses the nominal period, as published.
class LessConservativeLaw final : public PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 7 and period [s] > 0.
  LessConservativeLaw(int degrees_of_freedom, double period_s) : ledger_(degrees_of_freedom, period_s) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "fba-less"; }
  void credit(const Motion& motion) noexcept override { ledger_.credit(motion); }
  void lose(const Motion& motion) noexcept override { ledger_.lose(motion.interval_s); }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override;
  [[nodiscard]] bool allows(const Vector& force_N, double) const noexcept override;
  void commit(const Vector& force_N) noexcept override { ledger_.hold(force_N); }

  /// E_n [J].
  [[nodiscard]] double energy_J() const noexcept override { return ledger_.energy_J(); }

 private:
  Ledger ledger_;
};

}  // namespace forcebound::control
