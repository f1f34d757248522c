#include "forcebound/server/tissue/tissue_contact.hpp"

#include <cmath>
#include <stdexcept>

#include "forcebound/server/tissue/point_contact.hpp"
#include "forcebound/server/tissue/sphere_contact.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

// The places that a sphere pushes are this share of its radius apart.
constexpr double kApart = 0.5;

int divisions_for(const LinearTissue& tissue, double radius_m) {
  if (!(radius_m > 0)) return 1;
  const double longest_m = tissue.surface().longest_edge_m();
  const double divisions = std::ceil(longest_m / (kApart * radius_m));
  if (divisions <= SphereContact::kDivisionsMax) return static_cast<int>(divisions);
  throw std::runtime_error(tissue.mesh().name() + ": a sphere of radius " + text::to_text(radius_m) +
                           " m is too small beside edges of " + text::to_text(longest_m) +
                           " m: expected 0 (a point), or at least " +
                           text::to_text(longest_m / (kApart * SphereContact::kDivisionsMax)) + " m, or a finer mesh");
}

Point to_point(const std::array<double, 3>& values) noexcept { return Eigen::Map<const Point>(values.data()); }

}  // namespace

void ProbeOptions::check() const {
  const auto refuse = [](const std::string& what, double value) {
    throw std::invalid_argument(what + ", got " + text::to_text(value));
  };
  if (!(radius_m >= 0) || !std::isfinite(radius_m)) refuse("radius_m must be >= 0", radius_m);
  if (!(contact_stiffness_N_per_m > 0) || !std::isfinite(contact_stiffness_N_per_m)) {
    refuse("contact_stiffness_N_per_m must be > 0", contact_stiffness_N_per_m);
  }
  if (contacts_max < 1 || contacts_max > kContactsMax) {
    refuse("contacts_max must be from 1 to " + std::to_string(kContactsMax), contacts_max);
  }
  if (iterations_max < 1) refuse("iterations_max must be >= 1", iterations_max);
  if (!(tolerance > 0 && tolerance < 1)) refuse("tolerance must be > 0 and < 1", tolerance);
}

TissueModel::TissueModel(LinearTissue tissue, const ProbeOptions& options)
    : tissue_(std::move(tissue)), options_(options), tolerance_m_(options.tolerance * tissue_.mesh().mean_edge_m()) {
  options_.check();
  divisions_ = divisions_for(tissue_, options_.radius_m);
}

TissueResult TissueModel::step(TissueState& state, const Point& probe_m) const noexcept {
  if (!probe_m.allFinite()) return {.finite = false};
  if (state.contacts == 0) {
    const Point from_m = state.started == 0 ? probe_m : to_point(state.probe_m);
    const Point low_m = from_m.cwiseMin(probe_m).array() - options_.radius_m;
    const Point high_m = from_m.cwiseMax(probe_m).array() + options_.radius_m;
    if (tissue_.surface().is_clear_of(low_m, high_m)) {
      state.started = 1;
      Eigen::Map<Point>(state.probe_m.data()) = probe_m;
      return {};
    }
  }
  TissueState next = state;
  TissueResult result;
  if (options_.radius_m > 0) {
    result = SphereContact::step({tissue_, options_, tolerance_m_, divisions_}, next, probe_m);
  } else {
    result = PointContact(tissue_, options_, tolerance_m_, probe_m).step(next);
  }
  if (!result.force_N.allFinite() || !std::isfinite(result.energy_J)) return {.finite = false};
  state = next;
  return result;
}

}  // namespace forcebound::server
