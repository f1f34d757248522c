#include "tests/tools/reference/reference_exact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcebound::test {
namespace {

using Real = long double;

Real threshold(Real s, Real c) { return std::copysign(std::max(std::fabs(s) - c, Real{0}), s); }

/// How far the joint comes if each piece is passed at marginal cost p.
Real reached(const JointFacts& joint, const std::vector<ForcePiece>& pieces, Real p) {
  Real sum = 0;
  for (const auto& piece : pieces) {
    sum += threshold(p + piece.force_N, joint.friction_N) * piece.duration_s / (2 * Real{joint.damping_N_s_per_m});
  }
  return sum;
}

Real place(double reading, double step, int point, int points) {
  return points == 1 ? Real{reading} : reading + step * (Real(point) / (points - 1) - Real{0.5});
}

}  // namespace

Real least_cost_J(const JointFacts& joint, const std::vector<ForcePiece>& pieces, Real displacement_m) {
  Real time = 0;
  Real force = 0;
  for (const auto& piece : pieces) {
    time += piece.duration_s;
    force = std::max(force, std::fabs(Real{piece.force_N}));
  }
  Real high = force + joint.friction_N + 2 * joint.damping_N_s_per_m * std::fabs(displacement_m) / time;
  Real low = -high;
  for (int i = 0; i < 200 && low < high; ++i) {
    const Real middle = (low + high) / 2;
    (reached(joint, pieces, middle) < displacement_m ? low : high) = middle;
  }
  const Real p = (low + high) / 2;
  Real cost = p * displacement_m;
  for (const auto& piece : pieces) {
    const Real moving = threshold(p + piece.force_N, joint.friction_N);
    cost -= moving * moving * piece.duration_s / (4 * Real{joint.damping_N_s_per_m});
  }
  return cost;
}

Real least_energy_without_friction_J(const JointFacts& joint, double step_m,
                                     const std::vector<ReferenceReading>& readings) {
  // Without friction a sequence of pieces costs (b/h)(d - d0)^2 + constant, with h the whole time.
  struct Stage {
    Real stiffness, drift, constant;
  };
  std::vector<Stage> stages;
  std::vector<Real> x;
  for (const auto& reading : readings) {
    x.push_back(reading.position_m);
    Stage stage{0, 0, 0};
    Real time = 0;
    for (const auto& piece : reading.since) {
      time += piece.duration_s;
      stage.drift += piece.force_N * Real{piece.duration_s} / (2 * Real{joint.damping_N_s_per_m});
      stage.constant -= Real{piece.force_N} * piece.force_N * piece.duration_s / (4 * Real{joint.damping_N_s_per_m});
    }
    if (time > 0) stage.stiffness = joint.damping_N_s_per_m / time;
    stages.push_back(stage);
  }
  for (int sweep = 0; sweep < 20'000; ++sweep) {
    Real moved = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      Real weight = stages[i].stiffness;
      Real sum = i > 0 ? weight * (x[i - 1] + stages[i].drift) : Real{0};
      if (i + 1 < x.size()) {
        weight += stages[i + 1].stiffness;
        sum += stages[i + 1].stiffness * (x[i + 1] - stages[i + 1].drift);
      }
      const Real half = Real{step_m} / 2;
      const Real best = std::clamp(sum / weight, readings[i].position_m - half, readings[i].position_m + half);
      moved = std::max(moved, std::fabs(best - x[i]));
      x[i] = best;
    }
    if (moved < 1e-18L) break;
  }
  Real energy = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const Real d = x[i] - x[i - 1] - stages[i].drift;
    energy += stages[i].stiffness * d * d + stages[i].constant;
  }
  return energy;
}

Real least_energy_on_grid_J(const JointFacts& joint, double step_m, const std::vector<ReferenceReading>& readings,
                            int points) {
  const auto count = static_cast<std::size_t>(points);
  std::vector<Real> least(count, 0);
  for (std::size_t n = 1; n < readings.size(); ++n) {
    std::vector<Real> next(count, std::numeric_limits<Real>::infinity());
    for (int to = 0; to < points; ++to) {
      for (int from = 0; from < points; ++from) {
        const Real way =
            place(readings[n].position_m, step_m, to, points) - place(readings[n - 1].position_m, step_m, from, points);
        Real& best = next[static_cast<std::size_t>(to)];
        best = std::min(best, least[static_cast<std::size_t>(from)] + least_cost_J(joint, readings[n].since, way));
      }
    }
    least = next;
  }
  return *std::min_element(least.begin(), least.end());
}

}  // namespace forcebound::test
