#pragma once

#include <array>
#include <cstdint>

#include "forcebound/control/audit.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;

/// The linear part of a device in its joints, with the hand on it: A q'' + B q' + K (q - q0) = F(t) - friction.
struct JointSystem {
  Matrix inertia;    ///< A: the device's own and the hand's, J' m J [kg], [kg m^2]
  Matrix damping;    ///< B: the device's own and the hand's
  Matrix stiffness;  ///< K: the hand's
};

/// Forces on the joints during one piece of time: a constant motor torque, and the hand's pull as a cubic.
struct JointDrive {
  static constexpr int kTerms = 4;
  double length_s = 0;                   ///< of the piece
  Vector torque;                         ///< of the motors, constant [N], [N m]
  std::array<Vector, kTerms> hand_pull;  ///< coefficients over the time since the piece began, for q = q0 there
};

/// The motion of a device with damping, Coulomb friction and a hand on it, between two changes of its motor torque,
/// without time-stepping error.
///
///     A q'' = tau + F_h(t) - B q' - K (q - q0) - friction,     friction_i in c_i Sign(q_i')
///
/// Between events the equation is linear with a cubic right-hand side. Its solution is an entire function; we take its
/// power series, by recurrence, on steps short enough that it has converged to rounding. Joints with Coulomb friction
/// slide (the sign of the friction is fixed) or stick; a piece ends where a sliding joint comes to rest or the reaction
/// of a sticking one exceeds c_i: both are first roots of polynomials. Which joints at rest start to move is the
/// minimum of a convex function, 1/2 a'A a - g'a + sum c_i |a_i| over the accelerations a (Gauss' principle), so
/// several joints at once are no special case. Events are bounded: after `kEventsMax` in one piece a joint that would
/// have another sticks until the piece ends. That takes energy out and never puts any in; `frozen_joints()` counts it.
///
/// The audit P = integral(q'D q' + sum c_i |q_i'| - tau'q') is the integral of the same series, and its minimum is
/// searched on every step, not only at its ends.
///
/// Real time: noexcept, no allocation, bounded work. Owned by one thread.
class JointMotion {
 public:
  static constexpr int kEventsMax = 64;

  /// At rest at `start`.
  /// @param damping the device's own joint damping D: symmetric, positive semi-definite.
  /// @param friction Coulomb friction c of each joint, >= 0.
  JointMotion(const Matrix& damping, const Vector& friction, const Vector& start);

  /// Takes effect for the pieces that follow. The inertia must be positive definite.
  void set_system(const JointSystem& system) noexcept;

  void advance(const JointDrive& drive) noexcept;

  [[nodiscard]] const Vector& position() const noexcept { return position_; }
  [[nodiscard]] const Vector& velocity() const noexcept { return velocity_; }
  [[nodiscard]] control::PassivityAudit audit() const noexcept { return {energy_J_ + energy_rest_J_, minimum_J_}; }
  [[nodiscard]] std::uint64_t frozen_joints() const noexcept { return frozen_joints_; }

  /// The fastest rate of the present system [1/s]: an upper bound of its eigenvalues' magnitude, all joints free.
  [[nodiscard]] double fastest_rate() const noexcept;

 private:
  static constexpr int kTermsMax = 28;
  using Rows = std::array<double, control::kDofMax>;
  using Series = std::array<Rows, kTermsMax>;
  enum class Contact : std::uint8_t { frictionless, sticking, forward, backward, frozen };

  struct Event {
    double at = 1;   ///< share of the step
    int joint = -1;  ///< none
    Contact next = Contact::sticking;
  };

  [[nodiscard]] static double sign(Contact contact) noexcept;
  [[nodiscard]] bool stays(int joint) const noexcept;
  void choose_contacts(const Vector& force) noexcept;
  [[nodiscard]] Vector starting_accelerations(const Vector& force) const noexcept;
  void reduce_to_moving() noexcept;
  void set_force(const JointDrive& drive, double elapsed_s, double step_s) noexcept;
  void expand(double step_s) noexcept;
  [[nodiscard]] Event first_event(double step_s) const noexcept;
  [[nodiscard]] Event first_reversal(int joint) const noexcept;
  [[nodiscard]] Event first_break_away(int joint, double step_s) const noexcept;
  void account(const JointDrive& drive, double step_s, double share) noexcept;
  void move(double step_s, double share) noexcept;
  void meet(const Event& event, bool freeze) noexcept;

  int dof_;
  Matrix damping_;
  Vector friction_;
  JointSystem system_;

  Vector position_;
  Vector velocity_;
  Vector start_;  ///< of the piece
  std::array<Contact, control::kDofMax> contact_{};

  // Inverse inertia of the joints that move (zero rows for those that stick) and its products.
  Matrix mobility_;
  Matrix damping_rate_;
  Matrix stiffness_rate_;
  double rate_ = 0;  ///< of the moving joints [1/s]
  bool reduced_ = false;

  // The present step in s = time / step, 0..1.
  Series displacement_{};
  Series force_{};  ///< F in the step, motors and hand
  int terms_ = 0;

  double energy_J_ = 0;
  double energy_rest_J_ = 0;  ///< rounding error of energy_J_ (compensated summation)
  double minimum_J_ = 0;
  std::uint64_t frozen_joints_ = 0;
};

}  // namespace forcebound::device
