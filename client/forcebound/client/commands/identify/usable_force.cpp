#include "forcebound/client/commands/identify/usable_force.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/client/commands/identify/energy_solution.hpp"

namespace forcebound::client::commands::identify {
namespace {

constexpr double kWeakShare = 0.6;
constexpr double kStrongShare = 0.85;
constexpr std::size_t kWeakLeast = 10;  // slides, as six unknowns are fitted to them
constexpr std::size_t kStrongLeast = 3;

}  // namespace

UsableForce usable_force(const std::vector<Equation>& equations, const std::vector<double>& pushes, double quantile) {
  UsableForce force;
  if (pushes.empty()) return force;
  force.largest = *std::max_element(pushes.begin(), pushes.end());
  std::vector<Equation> weak;
  std::vector<Equation> strong;  // their ends
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    if (pushes[i] <= kWeakShare * force.largest) {
      for (const std::size_t at : {2 * i, 2 * i + 1}) {
        weak.push_back(equations[at]);
        weak.back().slide = (weak.size() - 1) / 2;
      }
    } else if (pushes[i] >= kStrongShare * force.largest) {
      strong.push_back(equations[2 * i + 1]);
    }
  }
  if (weak.size() / 2 < kWeakLeast || strong.size() < kStrongLeast) return force;

  const EnergySolution by_weak(weak, weak.size() / 2);
  const auto count = static_cast<double>(strong.size());
  Row mean_row = Row::Zero();  // of the energy's share
  for (const Equation& e : strong) {
    force.share += by_weak.energy_J(e.row) / (e.energy_J * count);
    mean_row += e.row / (e.energy_J * count);
  }
  double squares = 0;
  for (const Equation& e : strong) {
    const double off = by_weak.energy_J(e.row) / e.energy_J - force.share;
    squares += off * off;
  }
  const double scatter = std::sqrt(squares / (count * (count - 1)));
  force.share_error = quantile * std::hypot(scatter, by_weak.energy_error_J(mean_row));
  return force;
}

}  // namespace forcebound::client::commands::identify
