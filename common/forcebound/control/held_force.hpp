#pragma once

#include <optional>
#include <utility>

#include "forcebound/control/law.hpp"

namespace forcebound::control {

/// The interval between two ticks as the published laws see it: where it began, the force held over it, and B = b/T.
///
/// The damping is the one at the reading where the interval began, because the force was bounded with it: crediting the
/// interval with another one would break the identity that the proofs rest on.
class HeldForce {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 7 and period [s] > 0.
  HeldForce(int degrees_of_freedom, double period_s);

  /// The displacement d [m] from where the interval began to `motion`, or nothing if no interval runs.
  [[nodiscard]] std::optional<Vector> displacement(const Motion& motion) const noexcept {
    if (!damping_) return std::nullopt;
    return motion.position - position_;
  }

  /// Begins the next interval at `motion`.
  void begin(const Motion& motion) noexcept {
    position_ = motion.position;
    damping_ = *motion.damping;
  }

  /// Nothing is known of where the device is: no interval runs, no force is held.
  void lose() noexcept {
    damping_.reset();
    force_.setZero();
  }

  void hold(const Vector& force_N) noexcept { force_ = force_N; }

  [[nodiscard]] bool known() const noexcept { return damping_.has_value(); }
  [[nodiscard]] const Vector& force() const noexcept { return force_; }

  /// d'B d [J]: what the device dissipates at the very least over displacement d in one period.
  [[nodiscard]] double dissipation_J(const Vector& d) const noexcept { return damping_->dissipation(d) / period_s_; }

  /// f'B^-1 f / 4 [J]: the most that holding f for one period can return beyond what the device dissipates.
  [[nodiscard]] double reserve_J(const Vector& f) const noexcept {
    return damping_ ? damping_->mobility(f) * period_s_ / 4 : 0.0;
  }

  /// h f'b^-1 f / 4 [J]: the most that the force held can have returned in an interval of `interval_s` without usable
  /// readings. One that is shorter than the period or not measurable counts as a period.
  [[nodiscard]] double worst_case_J(double interval_s) const noexcept;

  /// The longest vector along `request_N`, but not longer than it, of which one period needs no more than `energy_J`:
  /// u min(|f_e|, sqrt(4 max(E, 0) / u'B^-1 u)) [Kim 2015, eq. 17]. The direction is never changed.
  [[nodiscard]] Vector bounded(const Vector& request_N, double energy_J) const noexcept;

  /// Whether holding `force_N` for one period needs no more than `energy_J`, to rounding.
  [[nodiscard]] bool affords(const Vector& force_N, double energy_J) const noexcept;

  /// b at the beginning of the interval; only while `known()`.
  [[nodiscard]] const Damping& damping() const noexcept { return *damping_; }
  [[nodiscard]] double period_s() const noexcept { return period_s_; }

 private:
  Vector position_;
  Vector force_;
  std::optional<Damping> damping_;
  double period_s_;
};

}  // namespace forcebound::control
