#include "forcebound/server/robot/friction_step.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace forcebound::server {
namespace {

// A joint at rest starts to slide this much above its friction, so that rounding cannot make it stick again at once.
constexpr double kSlideMargin = 1e-12;
constexpr int kRoundsTogether = 8;
constexpr int kRoundsMax = 200;

}  // namespace

bool FrictionStep::solve(const CoordinateMatrix& a, const Coordinates& r, const Coordinates& friction,
                         Coordinates& v) noexcept {
  const Eigen::Index rows = r.rows();
  for (int round = 0; round < kRoundsMax; ++round) {
    solve_moving(a, r, friction, v);
    const Coordinates left = r - a * v;
    bool right = true;
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (!(friction[i] > 0)) continue;
      int& guess = sign_[static_cast<std::size_t>(i)];
      const int better = corrected(guess, v[i], left[i], friction[i]);
      if (better == guess) continue;
      guess = better;
      right = false;
      if (round >= kRoundsTogether) break;
    }
    if (right) return true;
  }
  return false;
}

void FrictionStep::solve_moving(const CoordinateMatrix& a, const Coordinates& r, const Coordinates& friction,
                                Coordinates& v) const noexcept {
  const Eigen::Index rows = r.rows();
  std::array<Eigen::Index, kCoordinatesMax> moving{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (friction[i] > 0 && sign_[static_cast<std::size_t>(i)] == 0) continue;
    moving[static_cast<std::size_t>(count++)] = i;
  }
  CoordinateMatrix part(count, count);
  Coordinates force(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = moving[static_cast<std::size_t>(k)];
    force[k] = r[i] - (friction[i] > 0 ? friction[i] * sign_[static_cast<std::size_t>(i)] : 0);
    for (Eigen::Index l = 0; l < count; ++l) part(k, l) = a(i, moving[static_cast<std::size_t>(l)]);
  }
  v.setZero(rows);
  if (count == 0) return;
  const Coordinates speeds = Eigen::LLT<CoordinateMatrix>(part).solve(force);
  for (Eigen::Index k = 0; k < count; ++k) v[moving[static_cast<std::size_t>(k)]] = speeds[k];
}

/// What the guess about a joint becomes, by its velocity, or by the force that it needs for sticking.
int FrictionStep::corrected(int guess, double v, double left, double friction) const noexcept {
  if (guess != 0) return guess * v > 0 ? guess : 0;
  if (std::abs(left) <= friction * (1 + kSlideMargin)) return 0;
  return left > 0 ? 1 : -1;
}

}  // namespace forcebound::server
