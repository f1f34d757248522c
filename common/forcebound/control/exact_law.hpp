#pragma once

#include <limits>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/exact_ledger.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/law_description.hpp"

namespace forcebound::control {

/// How energy is spent over time: no matter of the guarantee, but of what is felt.
///
/// Chosen among twelve pairs on the paper's wall, circle and sphere with punctual and late ticks, and compared with no
/// such rules over devices, hands, stiffnesses, dampings and networks (README.md, Spending).
struct Spending {
  double memory_reserves = 2;  ///< energy is forgotten beyond what the largest force needs this many times
  double rise_per_s = 100;     ///< the share of the request that is shown rises by this much at the most
  /// And beyond this [J] it is forgotten in any case: of a robot, what its largest force needs is more than anybody
  /// wants it to save up.
  double memory_J_max = std::numeric_limits<double>::infinity();
};

/// The force bounding law for real devices: passive with quantised positions, late ticks, latency, friction, and facts
/// that are known within bounds.
///
/// Where the published laws credit what a reading seems to say, this one credits the least energy consistent with every
/// reading so far, LeastEnergy, of each joint; damping, friction, encoders and motors live in the joints and what is
/// held between ticks is the motors' torque tau = J'f. The force is chosen at a reading t_n, takes effect latency_n
/// after it, and is released by the device after the hold time T_hold:
///
///     E_n = sum_i min over g of ( min V_n,i,g  -  the reserves r of all pieces of time until f_n takes effect )
///     f_n = phi u, the largest phi <= |f_e| with  R(phi J'u) <= max(E_n, 0)
///     R(f) = sum_i  max( R_i(g- f_i), R_i(g+ f_i) - S_i )
///     R_i(f) = r(f, q f, T_1) + r(s f, q s f, T_2 - T_1),               r(m, k, t) = max(|m| + k - c, 0)^2 t/(4b)
///
/// where a motor makes g times the command, g a constant between g- and g+ (`torque_gain_share`), so that the energy is
/// least at one of these two (proof, Lemma 5; `losses_with_gain`: b and c are g times the facts'), and S_i >= 0 is what
/// joint i then has more at g+ than at g-. q is `torque_ripple_share`. The device holds all of a force until T_1 and
/// the share s until T_2, both the longest that the facts allow, T_1 and the actuator's lag together. What the lag
/// leaves of earlier forces is subtracted from E_n too. Scaling the torque scales the tip force: its direction is kept,
/// no inverse Jacobian appears, singular configurations are harmless. Without any energy the torque is what friction
/// holds: the largest one along J'u with g+ (1 + q) |tau_i| <= c_i. Where the tip turns, f is a force and a torque:
/// nothing changes, as all terms are energies of the joints. A coupled damping matrix D counts as the diagonal
/// `largest_diagonal_below` it.
///
/// Of times, torques, damping and friction only bounds need be known (DeviceFacts::uncertainty): V is taken over
/// everything within them. The proof is in README.md beside this file.
///
/// With EnergyMemory::capped, energy is spent as `Spending` says: what no force could need is forgotten, so that
/// contact does not ring, and a share of the request that had to be cut grows again by degrees. With EnergyMemory::full
/// the force is the longest that is allowed, at each tick. Then, without encoder step, friction, latency and
/// uncertainty, and with every interval equal to period and hold time, this is LessConservativeLaw for a diagonal b.
///
/// An interval that is not measurable (`is_measurable`) charges every force in effect and on its way a full hold time.
/// Then no force is given and nothing credited until intervals whose stamps are both believed (StampCheck) have lasted
/// as long as the last of these forces could, and one such interval, at least one, has ended with a reading: there V
/// starts again. An interval shorter than a tenth of the period is credited as that. A device that cannot let go of a
/// force (DeviceFacts::releases) is credited as measured; a tick later than the hold time is without the guarantee too,
/// and the deficit is repaid first.
///
/// Real time: noexcept, no allocation; dof times the cost of LeastEnergy for each torque in effect in an interval. A
/// copy is a saved state.
class ExactLaw final : public PassivityLaw {
 public:
  /// @throws std::invalid_argument unless the damping is symmetric positive definite of 1 to 7 rows, period and hold
  /// time are > 0 s, latency is 0 to 8 periods, friction and encoder steps are >= 0 with a row for each joint, and the
  /// uncertainty's brackets are the right way up and leave damping, hold time and latency a lower end to rely on.
  explicit ExactLaw(const DeviceFacts& facts, EnergyMemory memory = EnergyMemory::capped,
                    const Spending& spending = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "fba-exact"; }
  void credit(const Motion& motion) noexcept override;
  void lose(const Motion& motion) noexcept override;
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override;
  [[nodiscard]] bool allows(const Vector& force_N, double latency_s) const noexcept override;
  void commit(const Vector& force_N) noexcept override;

  /// E_n [J]; below zero while a deficit is repaid.
  [[nodiscard]] double energy_J() const noexcept override;

  /// What was forgotten because no force of this device could need it: nothing that is felt is lost by giving it away.
  [[nodiscard]] double energy_given_J() const noexcept override { return given_.value_J(); }

  void receive_energy(double energy_J) noexcept override;

  /// ExactLedger::knots_merged
  [[nodiscard]] bool knots_merged() const noexcept { return ledger_.knots_merged(); }

 private:
  void forget_excess() noexcept;

  Eigen::Index dof_;  // rows of a force
  double force_N_max_;
  double torque_N_m_max_;
  Eigen::Index rotations_;
  EnergyMemory memory_;
  Spending spending_;

  ExactLedger ledger_;
  EnergySum given_;
  Matrix jacobian_;
  double latency_s_max_ = 0;
  double interval_s_ = 0;
  double shown_share_ = 1;  // of the latest request
};

}  // namespace forcebound::control
