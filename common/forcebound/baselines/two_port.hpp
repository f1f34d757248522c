#pragma once

#include <optional>

#include "forcebound/control/held_force.hpp"
#include "forcebound/control/law.hpp"

/// What the laws with a half at the server share.
namespace forcebound::baselines {

using control::Vector;

/// A sum of the other half, which only grows. The largest heard counts, so that what was lost is made up by the next,
/// and what comes twice or late brings nothing.
class RemoteSum {
 public:
  /// What `sum` tells beyond all that was heard before; never negative. The first one heard tells nothing, unless the
  /// other half is known to have begun at zero.
  double hear(double sum) noexcept;

  void begin_at_zero() noexcept { largest_ = 0; }

 private:
  std::optional<double> largest_;
};

/// One number out of those that came; zero if there are fewer.
[[nodiscard]] inline double number_at(const control::PortNumbers& numbers, Eigen::Index at) noexcept {
  return at < numbers.rows() ? numbers[at] : 0.0;
}

/// The interval that ended with a reading. Where no reading tells where the device went, or no clock can have measured
/// how long it took, displacement, velocity and force are zero.
struct EndedInterval {
  Vector displacement;    ///< d [m]
  Vector velocity;        ///< d over the measured interval [m/s]
  Vector force;           ///< held over it [N]
  double interval_s = 0;  ///< as measured
  double unseen_J = 0;    ///< the most that the force can have returned between readings that cannot be used
};

/// Ends the interval of `held` at `motion` and begins the next there.
[[nodiscard]] EndedInterval next_interval(control::HeldForce& held, const control::Motion& motion) noexcept;

/// `displacement` of a place in the environment with so much taken out of it, along the force held, that the
/// environment gets `kept_back_J` less energy.
[[nodiscard]] Vector keeping_back(const Vector& displacement, const Vector& force_N, double kept_back_J) noexcept;

}  // namespace forcebound::baselines
