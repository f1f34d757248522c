#pragma once

#include <string>
#include <string_view>

#include "forcebound/control/handle.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::device {

using control::Matrix;
using control::Vector;

/// The hand that holds the device's tip: a mass that moves with it, and a spring and a damper to the hand's target.
/// Isotropic. A tip that turns it holds by a spring and a damper about the hand's orientation too.
struct Hand {
  double mass_kg = 0;
  double stiffness_N_per_m = 0;
  double damping_N_s_per_m = 0;
  double inertia_kg_m2 = 0;  ///< of the turning, as the next two
  double rotation_stiffness_N_m_per_rad = 0;
  double rotation_damping_N_m_s_per_rad = 0;
};

/// How a hand holds a tip that turns where nothing else is said: guesses, of the size of a relaxed wrist's.
inline constexpr Hand kRelaxedWrist{
    .inertia_kg_m2 = 5e-4, .rotation_stiffness_N_m_per_rad = 1, .rotation_damping_N_m_s_per_rad = 0.01};

/// A simulated person: the hand's target for the tip, as a function of time.
///
/// Real time: `target` and `handle` are noexcept and allocate nothing. Owned by the device that it moves.
class Operator {
 public:
  /// Position [m] and velocity [m/s] in the scene frame, `dof` rows each.
  struct Target {
    Vector position;
    Vector velocity;
    double grip = 1;  ///< share of the hand's stiffness and damping in the ms from here on; 0: released
  };

  virtual ~Operator() = default;

  /// As in its specification, e.g. "press".
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;

  [[nodiscard]] virtual const Hand& hand() const noexcept = 0;

  /// Translations of the tip that it moves.
  [[nodiscard]] virtual int degrees_of_freedom() const noexcept = 0;

  /// @param time_s since the device was first read, >= 0. Smooth in time; the device takes a sample each millisecond.
  [[nodiscard]] virtual Target target(double time_s) const noexcept = 0;

  /// The orientation that the hand wants of a tip that turns: the rotation vector that turns the scene's axes into the
  /// handle's [rad]. Sampled as `target`; in between it turns at a constant rate. Of a tip that does not turn, ignored.
  [[nodiscard]] virtual Eigen::Vector3d turn(double time_s) const noexcept {
    (void)time_s;
    return Eigen::Vector3d::Zero();
  }

  /// What it does with the handle then; absent: the handle has nothing.
  [[nodiscard]] virtual control::Handle handle(double time_s) const noexcept {
    (void)time_s;
    return {};
  }

  /// One line to print: name, hand and motion, each number with its unit.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace forcebound::device
