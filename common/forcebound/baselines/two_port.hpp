#pragma once

#include <optional>

#include "forcebound/control/held_force.hpp"
#include "forcebound/control/law.hpp"

/// Shared by the laws that have a server-side law, at both ends.
namespace forcebound::baselines {

using control::Vector;

/// A sum reported by the other end, which only grows. The largest received counts, so that the next message makes up
/// for lost ones, and duplicate or late ones add nothing.
class RemoteSum {
 public:
  /// The increase of `sum` over all received before; never negative. The first one gives zero, unless the other end is
  /// known to have begun at zero.
  double receive(double sum) noexcept;

  void begin_at_zero() noexcept { largest_ = 0; }

 private:
  std::optional<double> largest_;
};

/// One of the numbers received; zero if there are fewer.
[[nodiscard]] inline double number_at(const control::ServerLawNumbers& numbers, Eigen::Index at) noexcept {
  return at < numbers.rows() ? numbers[at] : 0.0;
}

/// The interval that ended with a reading. Where no reading tells where the device went, or its duration cannot have
/// been measured, displacement, velocity and force are zero.
struct EndedInterval {
  Vector displacement;    ///< d [m]
  Vector velocity;        ///< d over the measured interval [m/s]
  Vector force;           ///< held over it [N]
  double interval_s = 0;  ///< as measured
  double unseen_J = 0;    ///< the most energy that the force can have returned between unusable readings
};

/// Ends the interval of `held` at `motion` and begins the next there.
[[nodiscard]] EndedInterval next_interval(control::HeldForce& held, const control::Motion& motion) noexcept;

/// `displacement` of a position in the environment, reduced along the held force such that the environment gets
/// `kept_back_J` less energy.
[[nodiscard]] Vector keeping_back(const Vector& displacement, const Vector& force_N, double kept_back_J) noexcept;

}  // namespace forcebound::baselines
