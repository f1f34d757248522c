#include "forcebound/tissue/tissue_contact.hpp"

#include <cmath>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/other_contacts.hpp"
#include "forcebound/tissue/point_contact.hpp"
#include "forcebound/tissue/sphere_contact.hpp"

namespace forcebound::tissue {
namespace {

// Distance between the places that a sphere pushes, as a share of its radius.
constexpr double kApart = 0.5;

// Iterations of shift_near on a probe's first step.
constexpr int kTimesAtFirst = 4;

// Estimates of the cost of a step.
constexpr double kPoint_ns = 500;
constexpr double kSphere_ns = 2000;
constexpr double kSphereTriangle_ns = 5;
constexpr double kContact_ns = 3000;

// Three digits are off by half a percent at most.
constexpr double kRoundedUp = 1.005;

int divisions_for(const LinearTissue& tissue, double radius_m) {
  if (!(radius_m > 0)) return 1;
  const double longest_m = tissue.surface().longest_edge_m();
  const double divisions = std::ceil(longest_m / (kApart * radius_m));
  if (divisions <= SphereContact::kDivisionsMax) return static_cast<int>(divisions);
  throw std::runtime_error(
      tissue.mesh().name() + ": a sphere of radius " + text::to_text(radius_m) + " m is too small beside edges of " +
      text::rounded(longest_m) + " m: expected 0 (a point), or at least " +
      text::rounded(kRoundedUp * longest_m / (kApart * SphereContact::kDivisionsMax)) + " m, or a finer mesh");
}

}  // namespace

TissueModel::TissueModel(LinearTissue tissue, const ProbeOptions& options)
    : tissue_(std::move(tissue)), options_(options), tolerance_m_(options.tolerance * tissue_.mesh().mean_edge_m()) {
  options_.check();
  divisions_ = divisions_for(tissue_, options_.radius_m);
}

double TissueModel::step_ns() const noexcept {
  if (!(options_.radius_m > 0)) return kPoint_ns;
  const auto triangles = static_cast<double>(tissue_.surface().triangles().size());
  return kSphere_ns + kSphereTriangle_ns * triangles + kContact_ns * options_.contacts_max;
}

TissueResult TissueModel::step(TissueState& state, const scene::Point& probe_m, OtherContacts& others) const noexcept {
  return step_among(others.empty() ? nullptr : &others, state, probe_m);
}

TissueResult TissueModel::step_among(OtherContacts* others, TissueState& state,
                                     const scene::Point& probe_m) const noexcept {
  if (!probe_m.allFinite()) return {.finite = false};
  if (state.contacts == 0) {
    const double reach_m = options_.radius_m + (others != nullptr ? others->reach_m() : 0);
    if (is_way_clear(tissue_.surface(), state, probe_m, reach_m)) {
      state.started = 1;
      state.probe_m = scene::to_array(probe_m);
      state.shift_m = {};
      return {.energy_J = others != nullptr ? others->energy_J() : 0};
    }
  }
  TissueState next = state;
  TissueResult result;
  const scene::Point shift_m =
      others != nullptr ? shift_near(*others, state, probe_m) : scene::Point(scene::Point::Zero());
  if (options_.radius_m > 0) {
    const SphereContact::Setting setting{tissue_, options_, others, tolerance_m_, divisions_};
    result = SphereContact::step(setting, next, probe_m, shift_m);
  } else {
    result = PointContact(tissue_, options_, others, tolerance_m_, probe_m, shift_m).step(next);
  }
  if (!result.force_N.allFinite() || !std::isfinite(result.energy_J)) return {.finite = false};
  next.shift_m = scene::to_array(shift_m);
  state = next;
  return result;
}

// Displacement by the others of the surface near the probe. The nearest place depends on the displacement itself: a
// fixed-point iteration, continued from step to step.
scene::Point TissueModel::shift_near(OtherContacts& others, const TissueState& state,
                                     const scene::Point& probe_m) const noexcept {
  if (state.contacts > 0) return others.moved_m(place_of(state.contact[0]));
  scene::Point shift_m = state.started != 0 ? scene::to_point(state.shift_m) : scene::Point(scene::Point::Zero());
  const int times = state.started != 0 ? 1 : kTimesAtFirst;
  for (int n = 0; n < times; ++n) shift_m = others.moved_m(tissue_.surface().nearest(probe_m - shift_m).place);
  return shift_m;
}

}  // namespace forcebound::tissue
