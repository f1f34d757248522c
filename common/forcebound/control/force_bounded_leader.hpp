#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "forcebound/control/force_bounder.hpp"

namespace forcebound::control {

/// What is known of a joint of a leader arm and its servo, on the joint's side of the gears. Bounds: the truth is
/// never worse.
struct LeaderJoint {
  std::string name{};
  double damping_N_m_s_per_rad = 0;       ///< at least, while the servo is on: a motor driven by voltage brakes too
  double friction_N_m = 0;                ///< dry friction, at least
  double encoder_step_rad = 0;            ///< of two neighbouring readings
  double backlash_rad = 0;                ///< play between encoder and motor, from stop to stop
  double torque_N_m_max = 0;              ///< the most that the servo may be asked for
  double torque_step_N_m = 0;             ///< of two neighbouring commands; 0: any
  double torque_gain_share = 0;           ///< it makes its command times one constant, 1 and up to so much less or more
  double torque_ripple_share = 0;         ///< and that is off by up to this share, another one at each instant
  double speed_rad_per_s_max = 0;         ///< never exceeded, so that a reading beyond is lost; 0: not known
  double goal_stiffness_N_m_per_rad = 0;  ///< 0: it takes torques; else goals, and pulls there as such a spring
  double goal_rad_least = -std::numeric_limits<double>::infinity();
  double goal_rad_most = std::numeric_limits<double>::infinity();
};

/// A leader arm and its loop.
struct LeaderFacts {
  std::vector<LeaderJoint> joints{};
  double period_s = 1.0 / 60;   ///< nominal length of a step
  double latency_s_max = 0;     ///< from a reading's stamp until the torque that is chosen on it acts
  double read_s_max = 0;        ///< of that, from the stamp until the servos latch their positions
  double hold_s_max = 0;        ///< a torque acts no longer, but in a step that counts as late; 0: two periods, latency
  double watchdog_s_least = 0;  ///< 0: servos hold a torque until the next one; else they let go by themselves, no
                                ///< sooner than this after it began and no later than hold_s_max
  double clock_share = 1e-4;    ///< the clock of the stamps is fast or slow by up to this share
  double memory_J = 0.1;        ///< no joint saves more than this for later
};

/// Force feedback for a leader arm: turns the torques that a follower, a simulation or whatever else asks for into
/// torques that cannot make the arm return more energy than its own joints dissipated, however late, lost or wrong
/// that is. Each joint is bounded by an `fba-exact` of its own (ExactLaw), in joint space:
///
///     P_i(t) = integral of (b_i v^2 + c_i |v|) dt  -  integral of torque_i v dt  >=  0,     P = sum_i P_i
///
/// which is passive as each joint is, for any number of joints. What is lost against one law for all of them
/// (ExactLaw takes up to 7): energy that one joint saved is not spent by another, and where joints are cut by
/// different shares, the force at the tip turns. What is gained: a joint whose reading is lost does not stop others.
///
/// *Late steps.* Up to hold_s_max the promise holds for any jitter. Beyond, it holds if the servos have a watchdog;
/// without one the step counts as late, P may dip below zero by what the torque returned since hold_s_max, and that is
/// earned again before any more torque is given. A longer hold shows softer walls, 2b/hold_s_max and a bit.
///
/// *Servos that take goal positions.* A goal g = reading + torque/k makes the torque
///
///     k (g - x) = torque + k e - k (x - x_s),     e = reading - x_s,     x_s where the goal began to act
///
/// The last term takes energy until the next goal, never gives any: P less 1/2 k (x - x_s)^2 is that of a constant
/// torque. What is left is e, and what the servo misreads meanwhile: together at most step + backlash + speed latency.
/// It is sound where friction holds k times that, which therefore is taken off the friction, else the facts are
/// refused. The servo must pull as a spring whose
/// stiffness is constant: no integral part, no profile of speed or acceleration, no dead zone, no least torque. After
/// a lost reading the goal stays, and counts as a failed write. A servo whose *torque limit* can be written together
/// with each goal needs none of this: with a goal out of reach on the side of the torque, the limit is the torque.
///
/// Torque [N m] is what the servo does to the joint, positive as the angle [rad]; angles are unwrapped.
///
/// Real time: `step` is noexcept and allocates nothing. Not thread-safe; owned by the loop.
class ForceBoundedLeader {
 public:
  enum class Fault : std::uint8_t { none, interval_impossible, reading_lost, feedback_not_finite, late };

  struct Counts {
    std::uint64_t readings_lost = 0;        ///< of a joint: not finite or further than it can be so soon
    std::uint64_t feedback_not_finite = 0;  ///< of a joint: taken for zero
    std::uint64_t intervals_impossible = 0;
    std::uint64_t late = 0;  ///< steps after hold_s_max, of servos without a watchdog: not passive
    std::uint64_t writes_failed = 0;
    std::uint64_t saturated = 0;  ///< of a joint: feedback above its largest torque
  };

  /// @throws std::invalid_argument `leader: joint 'NAME': KEY must be ..., got ...`
  explicit ForceBoundedLeader(LeaderFacts facts);

  /// A step: the torques to command now. All spans have a number for each joint.
  /// @param feedback_N_m empty: there is none, or it is too old; the torques are zero then
  /// @param interval_s since the stamp of the step before, measured; of the first step not read. One that no clock
  /// can have measured gives zero torques, until no torque of before can still act
  void step(std::span<const double> position_rad, std::span<const double> feedback_N_m, double interval_s,
            std::span<double> torque_N_m) noexcept;

  /// A step whose readings are lost, all of them.
  void lose(double interval_s) noexcept;

  /// The torques of the last step may not have been written, or not in time: those before may act still.
  void report_failed_write() noexcept;

  /// What to write to a servo that takes goals: reading and torque/stiffness, in range; after a lost reading as
  /// before, not a number where there was none yet. Of other joints not a number.
  [[nodiscard]] double goal_rad(std::size_t joint) const noexcept { return joints_[joint].goal_rad; }

  /// What joint i may spend now [J]; below zero while a deficit is repaid.
  [[nodiscard]] double energy_J(std::size_t joint) const noexcept { return joints_[joint].bounder.law().energy_J(); }

  [[nodiscard]] std::size_t joints() const noexcept { return joints_.size(); }
  [[nodiscard]] Counts counts() const noexcept;

  /// Of the last step, the first of the faults, in one line: "joint 'elbow': reading lost, its torque is zero"; empty:
  /// there was none. Allocates.
  [[nodiscard]] std::string fault_in_words() const;

  /// With hold_s_max as it is in force.
  [[nodiscard]] const LeaderFacts& facts() const noexcept { return facts_; }

 private:
  struct Joint {
    ForceBounder bounder;
    Motion motion;
    double goal_rad = std::numeric_limits<double>::quiet_NaN();
    bool write_failed = false;
  };

  void store_fault(Fault fault, std::size_t joint) noexcept;
  void begin_step(double interval_s) noexcept;
  double step_joint(std::size_t i, double position_rad, const double* feedback_N_m) noexcept;

  LeaderFacts facts_;
  std::vector<Joint> joints_;
  bool begun_ = false;
  std::uint64_t late_ = 0;
  std::uint64_t writes_failed_ = 0;
  Fault fault_ = Fault::none;
  std::size_t faulty_joint_ = 0;
};

}  // namespace forcebound::control
