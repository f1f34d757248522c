#include "forcebound/tissue/contact_stiffness.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace forcebound::tissue {
namespace {

// A plane holds as far as the surface is about as flat: some edges of its triangles.
constexpr double kFlatEdges = 3;
constexpr double kFlatLeast_m = 5e-3;
constexpr double kFlatMost_m = 0.05;

// Depth of a sphere, as a share of its radius, that stands for all of what it is to meet: at the first touch its skin
// has no stiffness yet.
constexpr double kFirstDepth = 0.1;
// Of the radius: the change of place from which the slope of the skin's force follows.
constexpr double kNudge = 1e-3;

/// @param free_m where a probe begins to be pushed along the normal
bool put(const scene::Point& free_m, const scene::Point& normal, double stiffness_N_per_m,
         local_model::Surface& surface) noexcept {
  if (!free_m.allFinite() || !normal.allFinite() || !(stiffness_N_per_m > 0) || !std::isfinite(stiffness_N_per_m))
    return false;
  surface.place_m = free_m;
  surface.normal = normal;
  surface.stiffness_N_per_m = stiffness_N_per_m * normal * normal.transpose();
  return true;
}

/// Along a direction, of a force at a place [m/N].
double yield_m_per_N(const TissueModel& model, OtherContacts* others, const SurfacePlace& moved,
                     const SurfacePlace& pushed, const scene::Point& direction) noexcept {
  double yield = direction.dot(model.tissue().compliance_m_per_N(moved, pushed) * direction);
  if (others == nullptr) return yield;
  const OtherContacts::Directions along = direction;
  const OtherContacts::Rows one = others->coupled(moved, along);
  const OtherContacts::Rows other = others->coupled(pushed, along);
  return yield - one.col(0).dot(other.col(0));
}

/// The slope of a sphere's force along a normal, with the places that push and their direction held.
double sphere_stiffness_N_per_m(const TissueModel& model, OtherContacts* others, const TissueState& state,
                                const TissueResult& result) noexcept {
  const scene::Point direction = scene::to_point(state.direction);
  const scene::Point center_m = scene::to_point(state.probe_m);
  const auto count = static_cast<Eigen::Index>(std::min<std::uint32_t>(state.contacts, kContactsMax));
  ContactMatrix yields(count, count);
  ContactVector leads(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const SurfacePlace place = place_of(state.contact.at(static_cast<std::size_t>(k)));
    scene::Point moved_m = scene::Point::Zero();
    if (others != nullptr) moved_m = others->moved_m(place);
    const scene::Point away_m = center_m - model.tissue().surface().at(place) - moved_m;
    const scene::Point aside_m = away_m - direction * direction.dot(away_m);
    leads[k] = result.normal.dot(direction + aside_m / model.options().radius_m);
    for (Eigen::Index l = 0; l <= k; ++l) {
      yields(k, l) = yields(l, k) =
          yield_m_per_N(model, others, place, place_of(state.contact.at(static_cast<std::size_t>(l))), direction);
    }
    yields(k, k) += 1 / model.options().contact_stiffness_N_per_m;
  }
  const Eigen::LLT<ContactMatrix> factors(yields);
  if (factors.info() != Eigen::Success) return 0;
  const ContactVector pushed = factors.solve(leads);
  return leads.dot(pushed);
}

double stiffness_N_per_m(const TissueModel& model, OtherContacts* others, const TissueState& state,
                         const TissueResult& result) noexcept {
  if (model.options().radius_m > 0) return sphere_stiffness_N_per_m(model, others, state, result);
  const SurfacePlace place = place_of(state.contact[0]);
  return 1 /
         (yield_m_per_N(model, others, place, place, result.normal) + 1 / model.options().contact_stiffness_N_per_m);
}

/// How far a body with the stiffness at rest, turned with its nodes, moves along a load, by the load [m/N or alike].
double moved_along(const CorotationalTissue& tissue, CorotationalBody& body, const Eigen::VectorXd& load) noexcept {
  body.search.setZero();
  tissue.factors().solve(body.turns, load, body.search, body.scratch);
  return load.dot(body.search);
}

/// Of the tissue under a load at a place, in series with a spring.
double tied_stiffness_N_per_m(const CorotationalTissue& tissue, CorotationalBody& body, const SurfacePlace& place,
                              const scene::Point& normal) noexcept {
  body.residual.setZero();
  const DeformedSurface surface(tissue.surface(), body.now.displacement_m);
  surface.add_at(place, normal, body.residual);
  return 1 / (moved_along(tissue, body, body.residual) + 1 / tissue.options().contact_stiffness_N_per_m);
}

/// Of the tissue under the load by which a sphere's push on its nodes changes, in series with the skin.
double pressed_stiffness_N_per_m(const CorotationalTissue& tissue, CorotationalBody& body, const scene::Point& center_m,
                                 const scene::Point& normal) noexcept {
  const SpherePressure& pressure = *tissue.pressure();
  const DeformedSurface surface(tissue.surface(), body.now.displacement_m);
  const double nudge_m = kNudge * pressure.radius_m();
  const scene::Point nudged_m = nudge_m * normal;
  body.residual.setZero();
  body.product.setZero();
  pressure.add_forces(surface, center_m + nudged_m, body.residual);
  pressure.add_forces(surface, center_m - nudged_m, body.product);
  body.residual = (body.residual - body.product) / (2 * nudge_m);
  const double skin_N_per_m =
      -(pressure.touch(surface, center_m + nudged_m).force_N - pressure.touch(surface, center_m - nudged_m).force_N)
           .dot(normal) /
      (2 * nudge_m);
  if (!(skin_N_per_m > 0)) return 0;
  const double tissue_m_per_N = moved_along(tissue, body, body.residual) / (skin_N_per_m * skin_N_per_m);
  return 1 / (tissue_m_per_N + 1 / skin_N_per_m);
}

/// Where a probe that touches nothing is nearest to the surface at rest.
struct Above {
  SurfacePlace place;
  scene::Point free_m = scene::Point::Zero();  ///< where its centre touches
  scene::Point normal = scene::Point::UnitX();
};

bool is_above(const TissueSurface& surface, const scene::Point& probe_m, double radius_m, Above& above) noexcept {
  const double reach_m = radius_m + kModelledAbove_m;
  if (surface.is_clear_of(probe_m.array() - reach_m, probe_m.array() + reach_m)) return false;
  const TissueSurface::Nearest nearest = surface.nearest(probe_m);
  const scene::Point on_m = surface.at(nearest.place);
  if (!(nearest.height_m > 0) || !((probe_m - on_m).norm() <= reach_m)) return false;
  above = {.place = nearest.place, .free_m = on_m, .normal = surface.triangle_normal(nearest.place.triangle)};
  above.free_m += radius_m * above.normal;
  return true;
}

}  // namespace

double modelled_radius_m(const TetrahedralMesh& mesh) noexcept {
  return std::clamp(kFlatEdges * mesh.mean_edge_m(), kFlatLeast_m, kFlatMost_m);
}

bool describe_contact(const TissueModel& model, OtherContacts* others, const TissueState& state,
                      const TissueResult& result, local_model::Surface& surface) noexcept {
  if (state.started == 0 || !result.finite) return false;
  const scene::Point probe_m = scene::to_point(state.probe_m);
  if (others != nullptr && others->empty()) others = nullptr;
  if (result.contacts > 0 && state.contacts > 0) {
    const double slope_N_per_m = stiffness_N_per_m(model, others, state, result);
    surface.force_N = result.force_N;
    return put(probe_m + result.force_N / slope_N_per_m, result.normal, slope_N_per_m, surface);
  }
  Above above;
  const scene::Point shift_m = scene::to_point(state.shift_m);
  const double radius_m = model.options().radius_m;
  if (!is_above(model.tissue().surface(), probe_m - shift_m, radius_m, above)) return false;
  surface.force_N.setZero();
  const double stiffness = 1 / (yield_m_per_N(model, others, above.place, above.place, above.normal) +
                                1 / model.options().contact_stiffness_N_per_m);
  return put(above.free_m + shift_m, above.normal, stiffness, surface);
}

bool describe_contact(const CorotationalTissue& tissue, CorotationalBody& body, const TissueState& state,
                      const TissueResult& result, local_model::Surface& surface) noexcept {
  if (state.started == 0 || !result.finite) return false;
  const scene::Point probe_m = scene::to_point(state.probe_m);
  if (result.contacts > 0) {
    const double slope_N_per_m = tissue.pressure()
                                     ? pressed_stiffness_N_per_m(tissue, body, probe_m, result.normal)
                                     : tied_stiffness_N_per_m(tissue, body, place_of(state.contact[0]), result.normal);
    surface.force_N = result.force_N;
    return put(probe_m + result.force_N / slope_N_per_m, result.normal, slope_N_per_m, surface);
  }
  // Where others press, its surface is not the one at rest.
  if (!body.now.displacement_m.isZero(0)) return false;
  Above above;
  const double radius_m = tissue.pressure() ? tissue.pressure()->radius_m() : 0;
  if (!is_above(tissue.surface(), probe_m, radius_m, above)) return false;
  surface.force_N.setZero();
  const scene::Point pressed_m = above.free_m - kFirstDepth * radius_m * above.normal;
  const double stiffness = tissue.pressure() ? pressed_stiffness_N_per_m(tissue, body, pressed_m, above.normal)
                                             : tied_stiffness_N_per_m(tissue, body, above.place, above.normal);
  return put(above.free_m, above.normal, stiffness, surface);
}

}  // namespace forcebound::tissue
