#pragma once

#include <limits>
#include <string>

#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// A quantity of which only bounds are known: least <= truth <= most.
struct Bracket {
  double least = 0;
  double most = 0;

  friend bool operator==(const Bracket&, const Bracket&) = default;
};

/// How far the truth may be from a device's facts and from the stamps of its readings and commands. All zero: they are
/// exact. A law that promises passivity promises it for every truth within these bounds.
struct Uncertainty {
  Bracket stamp_s{};    ///< a reading was latched, or a reported effect or release happened, so long after its stamp
  Bracket latency_s{};  ///< the latency is longer than the facts' by this
  Bracket latency_offset_s{};  ///< and by one constant within this, counted from the readings' stamps: where a stamp is
                               ///< late by a constant, the effect is early by it
  Bracket hold_s{};            ///< each stage of the release comes later than the facts say by this
  double clock_share = 0;      ///< the clock of the stamps is faster or slower by up to this share
  double encoder_steps = 0;    ///< a reading is off by so many steps beyond the half that rounding explains
  double damping_share = 0;    ///< the damping is smaller by up to this share
  double friction_share = 0;   ///< likewise the friction
  Bracket torque_gain_share{};     ///< each motor's torque is the command times one constant, 1 and so much more
  bool losses_with_gain = false;   ///< damping and friction are told in units of the commands: each motor's gain times
                                   ///< these are the truth
  double torque_ripple_share = 0;  ///< and is off by up to this share of that, another one at each instant
  double actuator_lag_s = 0;  ///< the torque follows the command with a first-order lag of up to this time constant

  friend bool operator==(const Uncertainty&, const Uncertainty&) = default;
};

/// What is known of a haptic device, and all that a law may rely on.
///
/// Vectors and matrices have one row per joint. Damping, friction, encoders and motors of an arm live in its joints, so
/// these facts are given there: [N s/m], [N], [m] for a linear joint, [N m s/rad], [N m], [rad] for a turning one. A
/// Cartesian device is the case in which joints and task axes are the same. An arm may have more joints than its tip
/// has axes: all that joints dissipate counts in the joints, whether the tip moves or not.
struct DeviceFacts {
  std::string name;
  bool cartesian = true;      ///< the Jacobian is the identity
  int tip_axes = 0;           ///< degrees of freedom of the tip, where the joints are more; 0: as many as joints
  int rotations = 0;          ///< 3: the last three of those are rotations, and torques are shown too; 0: none is
  double period_s = 1e-3;     ///< nominal length of a tick
  Matrix damping;             ///< positive definite lower bound of the physical damping
  Vector friction;            ///< lower bound of the Coulomb friction, >= 0
  Vector encoder_step;        ///< distance of two neighbouring readings, 0: ideal
  Vector actuator_step;       ///< distance of two neighbouring commands, 0: ideal
  double force_N_max = 0;     ///< largest tip force the device may be asked for
  double torque_N_m_max = 0;  ///< largest torque at the tip, where there are rotations
  double hold_s_max =
      2e-3;  ///< the device layer holds a force in effect for so long without a new one, then releases it
  double release_share = 0;  ///< the release begins with this share of the force,
  double release_s = 0;      ///< held for so long; then there is none
  bool releases = true;      ///< false: it does not release, so that only the next command ends a force
  double latency_s = 0;      ///< from the command to the force at the actuator: what the tick cannot measure
  Vector speed_max{};        ///< no joint is ever faster, [m/s] or [rad/s]; no rows: not known
  Uncertainty uncertainty{};

  [[nodiscard]] int joints() const noexcept { return static_cast<int>(damping.rows()); }

  /// Rows of the Jacobian and of what is asked of a law: the force at the tip, and below it the torque, if there is
  /// one.
  [[nodiscard]] int degrees_of_freedom() const noexcept { return tip_axes > 0 ? tip_axes : joints(); }

  /// Rows of the tip's position, and of the force alone.
  [[nodiscard]] int translations() const noexcept { return degrees_of_freedom() - rotations; }
};

}  // namespace forcebound::control
