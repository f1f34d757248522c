#pragma once

#include <array>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/held_torques.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/control/least_energy.hpp"

namespace forcebound::control {

/// The force bounding law for real devices: passive with quantised positions, late ticks, latency and friction.
///
/// Where the published laws credit what a reading seems to say, this one credits the least energy consistent with every
/// reading so far, LeastEnergy, of each joint; damping, friction, encoders and motors live in the joints and what is
/// held between ticks is the motors' torque tau = J'f. The force is chosen at a reading t_n, takes effect latency_n
/// after it, and is let go of by the device after the hold time T_hold:
///
///     E_n = sum_i min V_n,i,   V from the readings, the measured intervals and what was in effect when
///     f_n = phi u, the largest phi <= |f_e| with  sum_i max(phi |(J'u)_i| - c_i, 0)^2 T_hold/(4 b_i) <= max(E_n, 0)
///
/// where what the forces still in effect may take until f_n takes effect is already subtracted from E_n. Scaling the
/// torque scales the tip force: its direction is kept, no inverse Jacobian appears, singular configurations are
/// harmless. Without any energy the torque is what friction holds: the largest one along J'u with |tau_i| <= c_i. A
/// coupled damping matrix D counts as lambda_min(S^-1 D S^-1) S^2, S^2 = diag(D).
///
/// Energy beyond what a force of f_max could ever need is forgotten (EnergyMemory::capped), so that contact does not
/// ring.
///
/// Without encoder step, friction and latency, and with every interval equal to period and hold time, this is
/// LessConservativeLaw for a diagonal b.
///
/// An interval that is not measurable (`is_measurable`) credits nothing and charges what the forces in effect and on
/// their way can take within one hold time in all, or until the newest is in effect where that is later. The forces on
/// their way stay in the queue, so that behind a latency the guarantee does not hold across such an interval. One
/// shorter than a tenth of the period is credited as that. A device that cannot let go of a force
/// (DeviceFacts::releases) is credited as measured; a tick later than the hold time is without the
/// guarantee too, and the deficit is repaid first.
///
/// Real time: noexcept, no allocation; dof times the cost of LeastEnergy for each torque in effect in an interval. A
/// copy is a saved state.
class ExactLaw final : public PassivityLaw {
 public:
  /// @throws std::invalid_argument unless the damping is symmetric positive definite of 1 to 6 rows, period and hold
  /// time are > 0 s, latency is 0 to 8 periods, friction and encoder steps are >= 0 with a row for each joint.
  explicit ExactLaw(const DeviceFacts& facts, EnergyMemory memory = EnergyMemory::capped);

  [[nodiscard]] std::string_view name() const noexcept override { return "fba-exact"; }
  void credit(const Motion& motion) noexcept override;
  void lose(const Motion& motion) noexcept override;
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override;
  [[nodiscard]] bool allows(const Vector& force_N, double latency_s) const noexcept override;
  void commit(const Vector& force_N) noexcept override;

  /// E_n [J]; below zero while a deficit is repaid.
  [[nodiscard]] double energy_J() const noexcept override { return energy_at(latency_s_max_); }

  /// Knots kept for each joint at most, for benchmarks.
  [[nodiscard]] int knots() const noexcept;

 private:
  [[nodiscard]] LeastEnergy::Tube tube(Eigen::Index joint, double reading) const noexcept;
  void note_times(const Motion& motion) noexcept;
  void let_act(double duration_s, double stretch) noexcept;
  void forget_excess() noexcept;
  [[nodiscard]] double energy_at(double latency_s) const noexcept;
  [[nodiscard]] double needed_J(const Vector& torque) const noexcept;
  [[nodiscard]] double largest_scale(const Vector& torque, double energy_J) const noexcept;

  Eigen::Index dof_;
  std::array<LeastEnergy, kDofMax> joints_;
  Vector encoder_step_;
  double period_s_;
  double hold_s_;
  double release_s_;  // infinite for a device that does not let go
  double force_N_max_;
  EnergyMemory memory_;

  EnergySum energy_;
  bool located_ = false;  // V is known
  Matrix jacobian_;
  HeldTorques held_;
  Vector committed_;  // when it takes effect, the next motion tells
  double latency_s_max_ = 0;
};

}  // namespace forcebound::control
