#pragma once

#include "forcebound/control/law.hpp"
#include "forcebound/control/ledger.hpp"

namespace forcebound::control {

/// No law: whatever is asked for is applied. The control group of every experiment; its ledger is kept all the same, so
/// that a run shows how much energy was given to the hand.
class TransparentLaw final : public PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 7 and period [s] > 0.
  TransparentLaw(int degrees_of_freedom, double period_s) : ledger_(degrees_of_freedom, period_s) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "none"; }
  void credit(const Motion& motion) noexcept override { ledger_.credit(motion); }
  void lose(const Motion& motion) noexcept override { ledger_.lose(motion.interval_s); }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override { return request_N; }
  void commit(const Vector& force_N) noexcept override { ledger_.hold(force_N); }

  /// The same balance as LessConservativeLaw's; nothing keeps it above zero.
  [[nodiscard]] double energy_J() const noexcept override { return ledger_.energy_J(); }

 private:
  Ledger ledger_;
};

}  // namespace forcebound::control
