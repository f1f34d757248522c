#include "forcebound/client/commands/identify/energy_balance.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/client/commands/identify/energy_solution.hpp"
#include "forcebound/client/commands/identify/slide_energy.hpp"
#include "forcebound/client/commands/identify/student.hpp"
#include "forcebound/client/commands/identify/usable_force.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client::commands::identify {
namespace {

// Beyond both the motions are not those of mass, damping and friction. The first in expected errors.
constexpr double kMisfitMost = 6;
constexpr double kResidualMost = 0.08;
constexpr int kSlidesForBounds = 8;

// What nothing here tells of: clocks, the Jacobian's rounding, the line between two readings.
constexpr double kEnergyShare = 0.003;
constexpr double kValueShare = 0.01;

std::string why_not(const EnergyBalance& balance, const EnergySolution& solution) {
  if (balance.slides < kSlidesForBounds) {
    return "only " + std::to_string(balance.slides) + " slides can be used, " + std::to_string(kSlidesForBounds) +
           " are needed";
  }
  if (balance.force.falls_short()) {
    return "its motors gave only " + text::rounded(100 * balance.force.share, 2) + " % of the largest push, " +
           text::rounded(balance.force.largest) + ", by the motion under smaller ones: try a smaller --force-share";
  }
  if (solution.misfit() > kMisfitMost && balance.residual_share > kResidualMost) {
    return "mass, damping and friction leave " + text::rounded(100 * balance.residual_share, 2) +
           " % of the energy unexplained; was a hand on the device, or does a spring or stop act?";
  }
  return {};
}

}  // namespace

EnergyBalance balance_energy(std::span<const Slide> slides, const ReleaseFit& fit, const BalanceSettings& settings) {
  EnergyBalance balance;
  for (std::size_t i = 0; i < slides.size(); ++i) {
    if (!fit.states[i].used) continue;
    const double end = slides[i].begin + slides[i].direction * slides[i].samples.back().progress;
    balance.from = std::min({balance.from, slides[i].begin, end});
    balance.to = std::max({balance.to, slides[i].begin, end});
  }
  std::vector<Equation> equations;
  std::vector<double> pushes;
  std::size_t used = 0;
  for (std::size_t i = 0; i < slides.size(); ++i) {
    if (!fit.states[i].used) continue;
    SlideEquations both = equations_of(slides[i], fit, fit.states[i], settings.encoder_step, balance.from, balance.to);
    both.at_release.slide = both.at_end.slide = used++;
    pushes.push_back(slides[i].push());
    equations.push_back(both.at_release);
    equations.push_back(both.at_end);
  }
  balance.slides = static_cast<int>(used);
  if (used == 0) {
    balance.damping.refused = balance.friction.refused = "no slide can be used";
    return balance;
  }
  const EnergySolution solution(equations, used);
  balance.weight = solution.value(kWeight);
  balance.residual_share = solution.residual_share();
  const double quantile = student_quantile(settings.confidence, std::max(5.0, static_cast<double>(used) - kCount));
  const auto bound_of = [&](int unknown) {
    const double margin = quantile * solution.error(unknown) +
                          settings.latency_error_s * solution.per_latency(unknown) +
                          kEnergyShare * solution.per_share(unknown) + kValueShare * std::abs(solution.value(unknown));
    return LowerBound{.estimate = solution.value(unknown), .bound = solution.value(unknown) - margin};
  };
  const LowerBound mass = bound_of(kMass);
  balance.mass = mass.estimate;
  balance.mass_error = mass.estimate - mass.bound;
  balance.damping = bound_of(kDamping);
  balance.friction = bound_of(kFirstPlace);
  for (int i = 0; i < kPlaces; ++i) {
    const LowerBound here = bound_of(kFirstPlace + i);
    balance.friction_at[static_cast<std::size_t>(i)] = here.estimate;
    if (here.bound < balance.friction.bound) balance.friction = here;
  }
  balance.force = usable_force(equations, pushes, quantile);
  balance.damping.refused = balance.friction.refused = why_not(balance, solution);
  return balance;
}

std::vector<SlidePoint> slide_points(std::span<const Slide> slides, const ReleaseFit& fit, double encoder_step) {
  std::vector<SlidePoint> points;
  for (std::size_t i = 0; i < slides.size(); ++i) {
    if (!fit.states[i].used) continue;
    const Equation end = equations_of(slides[i], fit, fit.states[i], encoder_step, -1, 1).at_end;
    const double way = std::abs(end.row[kWeight]);
    if (!(way > 0)) continue;
    points.push_back({.speed = end.row[kDamping] / way,
                      .force = (end.energy_J - fit.mass * end.row[kMass]) / way,
                      .direction = slides[i].direction});
  }
  return points;
}

}  // namespace forcebound::client::commands::identify
