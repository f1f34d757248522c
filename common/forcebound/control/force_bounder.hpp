#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/force_times.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/wrench.hpp"

namespace forcebound::control {

/// A law at work on a device: everything between what the environment asks for and what the device is told.
///
///     request -> finite? -> saturate at f_max along u -> law -> finite? within f_max? -> round to the actuator
///     -> commit the same number
///
/// Where the device shows torques, the request is a force and a torque below it, and both saturate by the same share,
/// at f_max or the largest torque, whichever comes first: that keeps the wrench's direction.
///
/// A request that is not finite is zero force. A reading that is not finite, or further from the last one than the
/// device's largest speed explains, is zero force too; the tick credits nothing and the force held is charged its worst
/// case. The first reading, at the start and after an interval that no clock can have measured, counts as a place only
/// once the next one is within reach of it: if that is not, nobody knows which of the two is wrong, and the law is told
/// that the clock failed, so that it starts again.
///
/// Rounding is toward zero in the joints, where motors are; a rounded force that the law would not allow (a coupled
/// damping matrix can make it so) becomes zero.
///
/// Less than 1e-150 N is zero, asked for or given, so that no force depends on what the processor does with denormals.
///
/// Real time: `tick` is noexcept, allocates nothing, O(dof^3). Not thread-safe; owned by the tick.
class ForceBounder {
 public:
  struct Counts {
    std::uint64_t requests_not_finite = 0;
    std::uint64_t readings_not_finite = 0;
    std::uint64_t readings_too_far = 0;        ///< further than the device can be so soon: taken for lost
    std::uint64_t writes_failed = 0;           ///< as the device told
    std::uint64_t effects_outside_facts = 0;   ///< reported before the command, or not when the facts allow
    std::uint64_t releases_outside_facts = 0;  ///< likewise
    std::uint64_t intervals_impossible = 0;    ///< not measurable, the first tick's aside: nothing credited
    std::uint64_t saturated = 0;
    std::uint64_t forces_not_finite = 0;  ///< of the law: a fault of its own
    std::uint64_t withdrawn = 0;          ///< chosen, but too late to be passive: zero force instead
  };

  /// @throws std::invalid_argument if `law` is null, the facts' vectors disagree in their number of rows, an actuator
  /// step or the largest force is negative or not a number, or there are actuator steps and more joints than axes.
  ForceBounder(const DeviceFacts& facts, std::unique_ptr<PassivityLaw> law);

  /// One tick without an answer of the environment, because there never was one or the newest is too old: notes the
  /// motion and gives zero force, whatever the law would give.
  [[nodiscard]] Vector release(const Motion& motion) noexcept;

  /// One tick: notes the motion and gives the force for the device [N]; always finite, `dof` rows.
  [[nodiscard]] Vector tick(const Motion& motion, const Vector& request_N) noexcept;

  /// The force that `tick` gave, or zero if it takes effect so long after the reading that the law no longer allows it,
  /// or sooner than it can: by a clock that ran back, so that nobody knows when.
  [[nodiscard]] Vector confirmed(const Vector& force_N, double latency_s) noexcept;

  /// What the server-side law said with the newest force, ahead of the tick that uses that force. If any
  /// number is not finite, all are ignored.
  void receive(const ServerLawNumbers& numbers) noexcept {
    if (numbers.allFinite()) law_->incoming(numbers);
  }

  /// Energy that a law elsewhere gave up, for this one to spend. One that is not finite or not above zero is none.
  void receive_energy(double energy_J) noexcept {
    if (energy_J > 0 && std::isfinite(energy_J)) law_->receive_energy(energy_J);
  }

  /// From now on another server answers, or the same one after a restart.
  void begin_server_side() noexcept { law_->begin_server_side(); }

  [[nodiscard]] const PassivityLaw& law() const noexcept { return *law_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] bool credit(const Motion& motion) noexcept;
  void count(const Motion& motion) noexcept;
  void lose(const Motion& motion) noexcept;
  void pass(double interval_s) noexcept;
  [[nodiscard]] bool within_reach(const Motion& motion) const noexcept;
  [[nodiscard]] Vector saturated(const Vector& request_N) noexcept;
  [[nodiscard]] Vector sound(const Vector& force_N) noexcept;
  [[nodiscard]] Vector rounded(const Vector& force_N, const Motion& motion) const noexcept;

  std::unique_ptr<PassivityLaw> law_;
  ForceTimes times_;
  Eigen::Index dof_;
  Vector actuator_step_;
  double latency_s_least_;
  bool cartesian_;
  WrenchLimits limits_;
  Vector reach_m_per_s_;  ///< no rows: not known
  Vector reading_error_;
  Vector reached_;               ///< the last reading that was used; no rows: there was none
  double since_reached_s_ = 0;   ///< infinite where the clock failed since
  bool reached_surely_ = false;  ///< the one before it was within reach
  StampCheck stamps_;
  Counts counts_;
};

}  // namespace forcebound::control
