#include "forcebound/tissue/point_contact.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "forcebound/tissue/other_contacts.hpp"

namespace forcebound::tissue {
namespace {

// Least decrease of the energy in an iteration; less is rounding error.
constexpr double kWorthwhileStep = 1e-13;

// Step lengths tried in one iteration, each half of the one before.
constexpr int kHalvings = 4;

}  // namespace

// Vector from a place, as displaced by the others, to the probe.
scene::Point PointContact::moved_from(const SurfacePlace& place) const noexcept {
  const scene::Point from_rest_m = probe_m_ - surface_.at(place);
  if (others_ == nullptr) return from_rest_m;
  return from_rest_m - others_->moved_m(place);
}

PointContact::Stuck PointContact::stick(const SurfacePlace& place) const noexcept {
  Eigen::Matrix3d compliance = tissue_.compliance_m_per_N(place, place);
  compliance.diagonal().array() += yield_m_per_N_;
  if (others_ != nullptr) {
    const OtherContacts::Rows coupled = others_->coupled(place, Eigen::Matrix3d::Identity());
    compliance -= coupled.transpose().lazyProduct(coupled);
  }
  const scene::Point moved_m = moved_from(place);
  Stuck here{.place = place, .stiffness_N_per_m = compliance.inverse()};
  here.pushed_N = here.stiffness_N_per_m * moved_m;
  here.energy_J = 0.5 * moved_m.dot(here.pushed_N);
  return here;
}

void PointContact::load_others(const Stuck& here) const noexcept {
  if (others_ == nullptr) return;
  others_->respond(others_->coupled(here.place, Eigen::Matrix3d::Identity()) * here.pushed_N);
}

Eigen::Matrix3d PointContact::deformed_corners(const Stuck& here, int triangle) const noexcept {
  const auto& pushed = surface_.triangles()[here.place.triangle];
  Eigen::Matrix3d corners;
  for (int corner = 0; corner < 3; ++corner) {
    const int node = surface_.triangles()[triangle][corner];
    scene::Point position_m = surface_.nodes_m()[node];
    for (int a = 0; a < 3; ++a) {
      if (!(here.place.weight[a] > 0)) continue;
      position_m += tissue_.compliance_m_per_N(node, pushed[a]) * (here.place.weight[a] * here.pushed_N);
    }
    if (others_ != nullptr) position_m += others_->moved_m(node) + others_->yielded_m(node);
    corners.col(corner) = position_m;
  }
  return corners;
}

void PointContact::try_along(const Stuck& here, const SurfacePlace& place, const scene::Point& change,
                             Move& best) const noexcept {
  // At most to where the first corner's weight is zero, and there exactly zero.
  double share = 1;
  int first = -1;
  for (int corner = 0; corner < 3; ++corner) {
    if (!(place.weight[corner] + share * change[corner] < 0)) continue;
    share = place.weight[corner] / -change[corner];
    first = corner;
  }
  if (!(share > 0)) return;
  for (int halving = 0; halving < kHalvings; ++halving, share *= 0.5, first = -1) {
    SurfacePlace there{.triangle = place.triangle, .weight = (place.weight + share * change).cwiseMax(0)};
    if (first >= 0) there.weight[first] = 0;
    there.weight /= there.weight.sum();
    const Stuck moved = stick(there);
    if (moved.energy_J < best.to.energy_J) {
      best = {moved, (surface_.at(there) - surface_.at(here.place)).norm()};
      return;
    }
  }
}

void PointContact::try_triangle(const Stuck& here, const SurfacePlace& place, Move& best) const noexcept {
  const Eigen::Matrix3d corners = deformed_corners(here, place.triangle);
  // Along the two edges from corner 0: how the energy falls, and how that changes, to first order.
  Eigen::Matrix<double, 3, 2> edges;
  edges << corners.col(1) - corners.col(0), corners.col(2) - corners.col(0);
  const Eigen::Vector2d fall = edges.transpose() * here.pushed_N;
  const Eigen::Matrix2d curvature = edges.transpose() * here.stiffness_N_per_m * edges;
  const Eigen::Vector2d change = curvature.inverse() * fall;
  if (!change.allFinite()) return;
  try_along(here, place, {-change.sum(), change[0], change[1]}, best);
  // Blocked by an edge, the slide continues along it.
  for (int corner = 0; corner < 3; ++corner) {
    if (place.weight[corner] > 0) continue;
    scene::Point along = scene::Point::Zero();
    along[(corner + 1) % 3] = 1;
    along[(corner + 2) % 3] = -1;
    const Eigen::Vector2d in_edges = along.tail<2>();
    const double share = fall.dot(in_edges) / in_edges.dot(curvature * in_edges);
    if (std::isfinite(share)) try_along(here, place, share * along, best);
  }
}

PointContact::Move PointContact::best_move(const Stuck& here) const noexcept {
  Move best{.to = here, .length_m = 0};
  load_others(here);
  const PlacesAround around = surface_.places_around(here.place);
  for (int k = 0; k < around.count; ++k) try_triangle(here, around.place[k], best);
  return best;
}

bool PointContact::pulls(const Stuck& here) const noexcept {
  const Eigen::Matrix3d corners = deformed_corners(here, here.place.triangle);
  const scene::Point outward = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
  return here.pushed_N.dot(outward) >= 0 &&
         moved_from(here.place).dot(surface_.triangle_normal(here.place.triangle)) >= 0;
}

TissueResult PointContact::step(TissueState& last) const noexcept {
  TissueResult result{.energy_J = others_ != nullptr ? others_->energy_J() : 0};
  TissueState next{
      .started = 1, .contacts = 0, .probe_m = scene::to_array(probe_m_), .shift_m = {}, .direction = {}, .contact = {}};
  if (const auto began = touched_place(surface_, last, probe_m_ - shift_m_)) {
    Stuck here = stick(*began);
    while (result.iterations < iterations_max_) {
      ++result.iterations;
      const Move move = best_move(here);
      const bool worthwhile = here.energy_J - move.to.energy_J > kWorthwhileStep * here.energy_J;
      result.residual_m = worthwhile ? move.length_m : 0;
      if (!worthwhile) break;
      here = move.to;
      if (move.length_m <= tolerance_m_) break;
    }
    result.converged = result.residual_m <= tolerance_m_;
    load_others(here);
    if (!pulls(here)) {
      result.contacts = 1;
      result.force_N = -here.pushed_N;
      result.normal = result.force_N.stableNormalized();
      result.energy_J += here.energy_J;
      result.depth_m = std::max(0.0, -moved_from(here.place).dot(surface_.triangle_normal(here.place.triangle)));
      next.contacts = 1;
      next.contact[0] = {here.place.triangle, scene::to_array(here.place.weight)};
    } else if (others_ != nullptr) {
      others_->respond_to_none();
    }
  }
  last = next;
  return result;
}

}  // namespace forcebound::tissue
