#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/accuracy/body_watch.hpp"

namespace forcebound::lab {
namespace {

using text::rounded;

std::string millimetres(double metres) { return rounded(1e3 * metres) + " mm"; }

}  // namespace

std::string place_trouble(const BodyRecord& run, const BodyRecord& reference) {
  constexpr double kLean_deg_max = 30;
  constexpr double kAside_radii_max = 2;
  for (std::size_t i = 0; i < std::min(run.places.size(), reference.places.size()); ++i) {
    const BodyPlace& is = run.places[i];
    const BodyPlace& should = reference.places[i];
    const scene::Point away_m = is.center_m - should.center_m;
    const double lean_deg = std::acos(std::clamp(is.up.dot(should.up), -1.0, 1.0)) * 180 / std::numbers::pi;
    if (std::abs(away_m.z()) > 0.5 * should.thickness_m) {
      return "'" + is.name + "' " + (away_m.z() < 0 ? "fell by " : "rose by ") + millimetres(std::abs(away_m.z()));
    }
    if (!is.is_round && lean_deg > kLean_deg_max)
      return "'" + is.name + "' fell over, by " + rounded(lean_deg) + " deg";
    if (away_m.norm() > kAside_radii_max * should.radius_m) {
      return "'" + is.name + "' left its place by " + millimetres(away_m.norm());
    }
  }
  return {};
}

std::string body_trouble(const BodyRecord& run, const BodyRecord& reference, bool places) {
  constexpr double kOfTurnover = 0.05;
  constexpr double kOfWeight = 0.01;
  constexpr double kDepths = 3;
  constexpr double kDepth_m = 0.0005;
  const double allowed_J = kOfTurnover * run.turned_over_J + kOfWeight * run.weight_J;
  if (!run.warnings.empty()) {
    return "MuJoCo warned " + std::to_string(run.warnings.begin()->second) + " times: " + run.warnings.begin()->first;
  }
  if (run.deepest_of_thickness > 1) {
    return "bodies " + millimetres(run.deepest_m) + " within each other: half through the thinner one";
  }
  if (run.deepest_m > kDepths * reference.deepest_m + kDepth_m) {
    return "bodies " + millimetres(run.deepest_m) + " within each other, in the reference " +
           millimetres(reference.deepest_m);
  }
  if (!run.is_driven && run.gained_J > allowed_J) {
    return "gained " + rounded(1e3 * run.gained_J) + " mJ of energy from nowhere";
  }
  return places ? place_trouble(run, reference) : std::string();
}

}  // namespace forcebound::lab
