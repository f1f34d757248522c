#pragma once

#include <array>
#include <optional>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/energy_sum.hpp"
#include "forcebound/control/force_times.hpp"
#include "forcebound/control/held_torques.hpp"
#include "forcebound/control/law.hpp"
#include "forcebound/control/least_energy.hpp"

namespace forcebound::control {

/// The least energy that a device can have dissipated beyond what its motors put in. Of each joint it is kept for the
/// least and the most gain of the motor (proof, Lemma 5).
///
/// Torques are given by the joints' rows [N] or [N m]. Real time: noexcept, no allocation; the cost of LeastEnergy for
/// each joint, each torque in effect in an interval, and each gain. A copy is a saved state.
class ExactLedger {
 public:
  using PerJoint = std::array<double, kJointsMax>;

  /// What is left at the time at which the next force takes effect [J].
  struct AtEffect {
    double energy_J = 0;      ///< with the worse gain of each joint
    PerJoint more_at_most{};  ///< S: so much more each joint has with the most gain, or 0
    bool lag_leaves = false;  ///< something of earlier torques that friction does not hold
  };

  /// @param facts as ExactLaw accepts them
  explicit ExactLedger(const DeviceFacts& facts);

  /// Lets the time since the previous reading pass, and has the torque committed last take effect in it or later.
  void pass(const Motion& motion) noexcept;

  /// The reading at the end of that time. It must not be lost.
  void read(const Vector& joint) noexcept;

  void commit(const Vector& torque) noexcept { committed_ = torque; }

  /// Energy that came, or was given away: both may be of either sign.
  void add_J(double energy_J) noexcept { energy_.add(energy_J); }

  /// Whether V is known, so that forces may be given.
  [[nodiscard]] bool located() const noexcept { return located_; }

  /// @param latency_s from the reading's stamp until the next force takes effect, at the most
  [[nodiscard]] AtEffect at_effect(double latency_s) const noexcept;

  /// What the next force may need of that. Nothing where not even the torque that friction holds is safe: with a
  /// deficit, while the lag has left something of a torque above it.
  [[nodiscard]] static std::optional<AtEffect> spendable(const AtEffect& left) noexcept;

  /// R: what a torque needs until its release, beside what the joints have more at the most gain.
  [[nodiscard]] double needed_J(const Vector& torque, const PerJoint& more_at_most = {}) const noexcept;

  /// The largest s with needed_J(s torque) <= energy.
  [[nodiscard]] double largest_scale(const Vector& torque, const AtEffect& spendable) const noexcept;

  /// The largest torque of each joint that is in effect or on its way.
  [[nodiscard]] Vector largest_held() const noexcept;

  /// Whether a joint's knots were ever merged: since then the energy may be less than could be known.
  [[nodiscard]] bool knots_merged() const noexcept;

 private:
  /// One joint, as it is with the least gain of its motor and with the most. One of them where the gain is known.
  struct Joint {
    LeastEnergy least;
    LeastEnergy most;
    EnergySum more;  ///< by so much the minimum of V at the most gain exceeds that at the least [J]
  };
  /// What a stage of the release needs in one joint, for s times a torque: weight max(s - begin, 0)^2 [J].
  struct Stage {
    double begin = 0;
    double weight = 0;
  };

  [[nodiscard]] bool gain_known() const noexcept { return gain_.least == gain_.most; }
  [[nodiscard]] const Joint& joint(Eigen::Index i) const noexcept { return joints_[static_cast<std::size_t>(i)]; }

  /// Adds to joint i's energy what `change_J(V, gain)` gives for each gain that its motor may have.
  template <typename Change>
  void add(Eigen::Index i, Change&& change_J) noexcept {
    Joint& joint = joints_[static_cast<std::size_t>(i)];
    const double least_J = change_J(joint.least, gain_.least);
    energy_.add(least_J);
    if (!gain_known()) joint.more.add(change_J(joint.most, gain_.most) - least_J);
  }

  [[nodiscard]] LeastEnergy::Tube tube(Eigen::Index joint, double reading) const noexcept;
  void queue_command(const Motion& motion) noexcept;
  void let_act(double duration_s, double stretch) noexcept;
  void charge_all() noexcept;
  [[nodiscard]] double spread_of(double size, double spread) const noexcept {
    return spread + ripple_share_ * (size + spread);
  }
  [[nodiscard]] double lag_can_take_J(const LeastEnergy& joint, double left) const noexcept;
  [[nodiscard]] double needed_J(const LeastEnergy& joint, double torque) const noexcept;
  [[nodiscard]] std::array<Stage, 2> stages(const LeastEnergy& joint, double torque) const noexcept;

  Eigen::Index joint_count_;
  std::array<Joint, kJointsMax> joints_;
  Vector encoder_half_;
  double period_s_;
  ForceTimes times_;
  ReleaseStages paid_;  // the stages that the reserve of a force is for
  Bracket stamp_s_;
  Bracket latency_s_;  // beyond what the motion says
  Bracket gain_;       // of each motor
  double ripple_share_;
  double lag_s_;

  EnergySum energy_;      // with the least gain of all motors
  bool located_ = false;  // V is known
  double blind_s_ = 0;    // so long no force and no credit: the forces in effect are not known
  StampCheck stamps_;
  HeldTorques held_;
  Vector committed_;  // when it takes effect, the next motion tells
};

}  // namespace forcebound::control
