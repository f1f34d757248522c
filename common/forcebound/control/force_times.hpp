#pragma once

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/held_torques.hpp"
#include "forcebound/control/law.hpp"

namespace forcebound::control {

/// How much longer than the facts' latency a force may take. What is one constant counts as another one each time, of
/// which it is a case.
[[nodiscard]] Bracket later_than_told(const Uncertainty& uncertainty) noexcept;

/// When a force took effect and when the device released it, within the brackets that the facts and the device's own
/// reports leave.
///
/// Times [s] are true ones and count from the stamp of the reading at which the force was chosen. A report that the
/// facts allow takes their place, with the uncertainty of a stamp. One that cannot be, of an effect before its command
/// or of a release before the effect, is not believed: the facts hold. Of any other report that the facts do not allow,
/// nobody knows whether it is wrong or they are: the bracket holds both.
///
/// Real time: noexcept, no allocation. A value.
class ForceTimes {
 public:
  explicit ForceTimes(const DeviceFacts& facts) noexcept;

  /// When the force took effect; `motion` is the first one after it was committed.
  [[nodiscard]] Bracket effect(const Motion& motion) const noexcept;

  /// How it is released, if it took effect within `begin_s`.
  [[nodiscard]] ReleaseStages release(const Motion& motion, const Bracket& begin_s) const noexcept;

  /// Whether the device reports an effect before its command, or earlier or later than the facts allow.
  [[nodiscard]] bool effect_is_outside_facts(const Motion& motion) const noexcept;

  /// Likewise its release.
  [[nodiscard]] bool release_is_outside_facts(const Motion& motion) const noexcept;

  /// The true length of a time that the clock showed.
  [[nodiscard]] Bracket true_time(double shown_s) const noexcept;

  /// All of the stages that a force may take at the most, and so must be paid for.
  [[nodiscard]] const ReleaseStages& longest_release() const noexcept { return longest_release_; }

 private:
  [[nodiscard]] Bracket later(double shown_s, const Bracket& by_s) const noexcept;
  [[nodiscard]] Bracket effect_by_facts(const Motion& motion) const noexcept;
  [[nodiscard]] double commanded(const Motion& motion) const noexcept;
  [[nodiscard]] bool before_command(const Motion& motion, const Bracket& reported_s) const noexcept;
  [[nodiscard]] ReleaseStages reported_release(const Bracket& at_s, const Bracket& begin_s) const noexcept;

  ReleaseStages longest_release_;
  ReleaseStages release_by_facts_;  ///< the same, or never for a device that does not release
  Bracket stamp_s_;
  Bracket latency_s_;       ///< later than the facts' latency says
  double latency_facts_s_;  ///< after the command
  double clock_rate_;       ///< true seconds for one of the clock's at most; at least its inverse
};

}  // namespace forcebound::control
