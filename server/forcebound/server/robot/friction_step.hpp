#pragma once

#include <Eigen/Core>
#include <array>

namespace forcebound::server {

/// Most coordinates of a simulated robot and what it moves.
inline constexpr int kCoordinatesMax = 16;
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kCoordinatesMax, 1>;
using CoordinateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kCoordinatesMax, kCoordinatesMax>;

/// The velocity at the end of a step with dry friction, which acts at that very velocity:
///
///     A v = r - g,    g_i = c_i sign(v_i) where v_i is not zero, and within +-c_i where it is
///
/// This is the minimum of v'A v/2 - r'v + sum c_i |v_i|, which exists once for A symmetric positive definite. A joint
/// that sticks has a velocity of exactly zero, and one that slides is braked by exactly c_i against its motion, so that
/// friction takes exactly c_i |dq_i| in the step.
///
/// Found by active sets: all wrong guesses are changed at once; if that does not end, the first wrong one alone, which
/// does [Murty 1974]. It remembers its guess from step to step.
///
/// Real time: noexcept, no allocation.
class FrictionStep {
 public:
  /// @param friction c_i, an impulse or in the unit of r; only its first rows need friction
  /// @return whether v is that minimum; if not (rounding), sticking joints stick and friction is what it came to
  bool solve(const CoordinateMatrix& a, const Coordinates& r, const Coordinates& friction, Coordinates& v) noexcept;

 private:
  void solve_moving(const CoordinateMatrix& a, const Coordinates& r, const Coordinates& friction,
                    Coordinates& v) const noexcept;
  [[nodiscard]] int corrected(int guess, double v, double left, double friction) const noexcept;

  std::array<int, kCoordinatesMax> sign_{};  // of the velocity; 0: sticks
};

}  // namespace forcebound::server
