#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/effect_probe.hpp"

namespace forcebound::test {

/// Work of a field's force around a closed loop, and the sum of its magnitudes.
struct LoopWork {
  double sum_J = 0;
  double moved_J = 0;  ///< the sum of its magnitudes

  [[nodiscard]] double share() const { return moved_J > 0 ? std::abs(sum_J) / moved_J : 0; }
};

/// Of a field at rest, around the closed curve place_m(angle), 0 <= angle <= 2 pi, by the midpoint rule.
inline LoopWork work_around(const scene::Effect& effect, const std::function<scene::Point(double)>& place_m) {
  constexpr int kSteps = 20000;
  const auto at = [&](double step) { return place_m(2 * std::numbers::pi * step / kSteps); };
  LoopWork work;
  for (int step = 0; step < kSteps; ++step) {
    const double work_J = force_N(effect, {.position_m = at(step + 0.5)}).dot(at(step + 1) - at(step));
    work.sum_J += work_J;
    work.moved_J += std::abs(work_J);
  }
  return work;
}

/// An asymmetric loop of some 0.1 m around a point.
inline std::function<scene::Point(double)> crooked_loop(const scene::Point& around_m) {
  return [around_m](double angle) -> scene::Point {
    return around_m + scene::Point(0.05 * std::cos(angle) + 0.02, 0.04 * std::sin(angle) + 0.01 * std::cos(2 * angle),
                                   0.03 * std::sin(angle + 1) - 0.01 * std::sin(3 * angle));
  };
}

}  // namespace forcebound::test
