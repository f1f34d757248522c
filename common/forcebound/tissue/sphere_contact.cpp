#include "forcebound/tissue/sphere_contact.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/tissue/sphere_depth.hpp"

namespace forcebound::tissue {
namespace {

// Active sets tried on the small system in an iteration: each contact may enter and leave a few times.
constexpr int kSetsMax = 6 * kContactsMax;

constexpr double kSameWeight = 1e-9;

// A place faces the sphere if the cosine between its normal and the direction is at least this.
constexpr double kFacing = 0.1;

// A surface leads from one place to another that is not steeper above it.
constexpr double kSteepest = 2;

// The direction is as good as the surface's if they differ by less (cosine of 8 degrees).
constexpr double kAligned = 0.99;

// Direction along which a contact at this place would push a sphere off.
scene::Point direction_at(const TissueSurface& surface, const SurfacePlace& place,
                          const scene::Point& probe_m) noexcept {
  const scene::Point outward = surface.triangle_normal(place.triangle);
  const scene::Point away_m = probe_m - surface.at(place);
  if (away_m.dot(outward) <= 0) return outward;
  return away_m.stableNormalized();
}

}  // namespace

SphereContact::SphereContact(const Setting& setting, const TissueState& last, const Begin& begin,
                             const scene::Point& direction) noexcept
    : tissue_(setting.tissue),
      surface_(setting.tissue.surface()),
      options_(setting.options),
      others_(setting.others),
      last_(last),
      probe_m_(begin.probe_m),
      beside_rest_m_(begin.probe_m - begin.shift_m),
      direction_(direction),
      tolerance_m_(setting.tolerance_m),
      divisions_(setting.divisions),
      force_N_(ContactVector::Zero(0)) {
  find_anchors(begin.first);
  fill_pool();
  restore_working_set();
}

SphereContact::Pushed SphereContact::pushed_at(const SurfacePlace& place) const noexcept {
  const SphereDepth at_rest(probe_m_ - surface_.at(place), direction_, options_.radius_m);
  const double moved_m = others_ != nullptr ? others_->moved_m(place).dot(direction_) : 0;
  return {.place = place,
          .depth_m = at_rest.depth_m + moved_m,
          .below_m = at_rest.below_m + moved_m,
          .aside_m = at_rest.aside_m};
}

void SphereContact::find_anchors(const SurfacePlace& first) noexcept {
  for (std::uint32_t k = 0; k < last_.contacts; ++k) {
    anchors_[anchor_count_++] = pushed_at(place_of(last_.contact[k]));
  }
  if (anchor_count_ == 0) anchors_[anchor_count_++] = pushed_at(first);
  deepest_m_ = options_.radius_m;
  for (int k = 0; k < anchor_count_; ++k) {
    deepest_m_ = std::max(deepest_m_, anchors_[k].below_m + options_.radius_m + anchors_[k].aside_m.norm());
  }
}

void SphereContact::fill_pool() noexcept {
  // Beyond this distance the paraboloid is above a flat surface.
  const double wide_m = std::sqrt(2 * options_.radius_m * deepest_m_) + deepest_m_;
  for (int t = 0; t < static_cast<int>(surface_.triangles().size()); ++t) {
    const scene::Point& a = surface_.corner_m(t, 0);
    const scene::Point& b = surface_.corner_m(t, 1);
    const scene::Point& c = surface_.corner_m(t, 2);
    const scene::Point outside_m =
        (a.cwiseMin(b).cwiseMin(c) - beside_rest_m_).cwiseMax(beside_rest_m_ - a.cwiseMax(b).cwiseMax(c));
    if (outside_m.cwiseMax(0).squaredNorm() <= wide_m * wide_m) fill_pool_from(t);
  }
}

void SphereContact::fill_pool_from(int triangle) noexcept {
  if (group_count_ == kPoolMax) return;
  groups_[group_count_].triangle = triangle;
  const int before = pool_count_;
  for (int first = 0; first <= divisions_; ++first) {
    for (int second = 0; first + second <= divisions_; ++second) {
      const std::array<int, 3> parts{first, second, divisions_ - first - second};
      if (!owns(triangle, parts)) continue;
      const scene::Point weight = scene::Point(parts[0], parts[1], parts[2]) / divisions_;
      Pushed one = pushed_at({.triangle = triangle, .weight = weight});
      one.group = group_count_;
      if (one.depth_m > 0 && is_reached(one)) keep(one);
    }
  }
  if (pool_count_ > before) ++group_count_;
}

bool SphereContact::owns(int triangle, const std::array<int, 3>& parts) const noexcept {
  const auto zeros = std::ranges::count(parts, 0);
  if (zeros == 0) return true;
  if (zeros == 2) {
    const auto corner = std::ranges::max_element(parts) - parts.begin();
    return surface_.first_triangle(surface_.triangles()[triangle][corner]) == triangle;
  }
  const auto corner = std::ranges::find(parts, 0) - parts.begin();
  const int other = surface_.beyond(triangle, static_cast<int>(corner));
  return other == TissueSurface::kNone || triangle < other;
}

scene::Point SphereContact::mean_normal() const noexcept {
  scene::Point sum_N = scene::Point::Zero();
  for (int k = 0; k < working_count_; ++k) sum_N += force_N_[k] * surface_.normal_at(pool_[working_[k]].place);
  return sum_N.stableNormalized();
}

bool SphereContact::is_reached(const Pushed& one) const noexcept {
  if (surface_.normal_at(one.place).dot(direction_) <= kFacing) return false;
  return std::any_of(anchors_.begin(), anchors_.begin() + anchor_count_, [&](const Pushed& anchor) {
    const double aside_m = (one.aside_m - anchor.aside_m).norm();
    return one.below_m - anchor.below_m <= kSteepest * aside_m + 0.5 * options_.radius_m;
  });
}

void SphereContact::keep(const Pushed& one) noexcept {
  if (pool_count_ < kPoolMax) {
    pool_[pool_count_++] = one;
    return;
  }
  ++pool_left_out_;
  const auto shallowest = std::ranges::min_element(pool_, {}, &Pushed::depth_m);
  if (shallowest->depth_m < one.depth_m) *shallowest = one;
}

void SphereContact::restore_working_set() noexcept {
  for (std::uint32_t k = 0; k < last_.contacts && working_count_ < options_.contacts_max; ++k) {
    const scene::Point weight = scene::to_point(last_.contact[k].weight);
    for (int candidate = 0; candidate < pool_count_; ++candidate) {
      const SurfacePlace& place = pool_[candidate].place;
      if (place.triangle != last_.contact[k].triangle || (place.weight - weight).norm() > kSameWeight) continue;
      working_[working_count_++] = candidate;
      break;
    }
  }
}

double SphereContact::yield(const Pushed& k, const Pushed& l) const noexcept {
  const auto& at = surface_.triangles()[k.place.triangle];
  const auto& by = surface_.triangles()[l.place.triangle];
  double sum = 0;
  for (int b = 0; b < 3; ++b) {
    if (!(l.place.weight[b] > 0)) continue;
    scene::Point moved = scene::Point::Zero();
    for (int a = 0; a < 3; ++a) {
      if (k.place.weight[a] > 0) moved += tissue_.compliance_m_per_N(at[a], by[b]) * (k.place.weight[a] * direction_);
    }
    sum += l.place.weight[b] * direction_.dot(moved);
  }
  return sum;
}

void SphereContact::solve() noexcept {
  compliance_.resize(working_count_, working_count_);
  couple();
  ContactVector gap_m(working_count_);
  for (int k = 0; k < working_count_; ++k) {
    gap_m[k] = -pool_[working_[k]].depth_m;
    for (int l = 0; l <= k; ++l) {
      compliance_(k, l) = compliance_(l, k) = yield(pool_[working_[k]], pool_[working_[l]]);
    }
    compliance_(k, k) += 1 / options_.contact_stiffness_N_per_m;
  }
  if (others_ != nullptr) compliance_ -= coupled_.transpose().lazyProduct(coupled_);
  force_N_ = solve_contacts(compliance_, gap_m, kSetsMax).force_N;
  load_others();
}

void SphereContact::couple() noexcept {
  if (others_ == nullptr) return;
  for (int k = 0; k < working_count_; ++k) {
    const OtherContacts::Rows column = others_->coupled(pool_[working_[k]].place, -direction_);
    if (k == 0) coupled_.resize(column.rows(), working_count_);
    coupled_.col(k) = column;
  }
}

void SphereContact::load_others() const noexcept {
  if (others_ == nullptr) return;
  if (force_N_.size() == 0) {
    others_->respond_to_none();
  } else {
    others_->respond(coupled_ * force_N_);
  }
}

void SphereContact::deform() noexcept {
  struct Load {
    int node;
    scene::Point force_N;
  };
  std::array<Load, 3 * kContactsMax> loads;
  int count = 0;
  for (int k = 0; k < working_count_; ++k) {
    const Pushed& one = pool_[working_[k]];
    for (int corner = 0; corner < 3; ++corner) {
      const double share_N = one.place.weight[corner] * force_N_[k];
      if (!(share_N > 0)) continue;
      const int node = surface_.triangles()[one.place.triangle][corner];
      const auto known =
          std::find_if(loads.begin(), loads.begin() + count, [&](const Load& l) { return l.node == node; });
      if (known == loads.begin() + count) loads[count++] = {node, scene::Point::Zero()};
      known->force_N -= share_N * direction_;
    }
  }
  for (int g = 0; g < group_count_; ++g) {
    for (int corner = 0; corner < 3; ++corner) {
      const int node = surface_.triangles()[groups_[g].triangle][corner];
      scene::Point moved_m = scene::Point::Zero();
      for (int l = 0; l < count; ++l) moved_m += tissue_.compliance_m_per_N(node, loads[l].node) * loads[l].force_N;
      if (others_ != nullptr) moved_m += others_->yielded_m(node);
      groups_[g].moved_m.col(corner) = moved_m;
    }
  }
}

double SphereContact::gap(int candidate) const noexcept {
  const Pushed& one = pool_[candidate];
  return -one.depth_m - direction_.dot(groups_[one.group].moved_m * one.place.weight);
}

bool SphereContact::is_working(int candidate) const noexcept {
  return std::find(working_.begin(), working_.begin() + working_count_, candidate) != working_.begin() + working_count_;
}

int SphereContact::deepest_beside() const noexcept {
  int deepest = -1;
  double deepest_gap_m = -tolerance_m_;
  for (int candidate = 0; candidate < pool_count_; ++candidate) {
    const double gap_m = gap(candidate);
    if (gap_m >= deepest_gap_m || is_working(candidate)) continue;
    deepest = candidate;
    deepest_gap_m = gap_m;
  }
  return deepest;
}

int SphereContact::deepest_at_rest() const noexcept {
  const auto shallower = [](const Pushed& a, const Pushed& b) { return a.depth_m < b.depth_m; };
  return static_cast<int>(std::max_element(pool_.begin(), pool_.begin() + pool_count_, shallower) - pool_.begin());
}

TissueResult SphereContact::solve_all() noexcept {
  TissueResult result{.energy_J = others_ != nullptr ? others_->energy_J() : 0};
  if (pool_count_ == 0) return result;
  if (working_count_ == 0) working_[working_count_++] = deepest_at_rest();
  for (;;) {
    ++result.iterations;
    solve();
    deform();
    const int next = deepest_beside();
    result.residual_m = next < 0 ? 0 : -gap(next);
    if (next < 0) break;
    if ((force_N_.array() > 0).count() == options_.contacts_max) break;
    if (result.iterations == options_.iterations_max) {
      pending_ = next;
      break;
    }
    // Contacts that no longer push are replaced first.
    int kept = 0;
    for (int k = 0; k < working_count_; ++k) {
      if (force_N_[k] > 0) working_[kept++] = working_[k];
    }
    working_count_ = kept;
    working_[working_count_++] = next;
  }
  conclude(result);
  return result;
}

void SphereContact::conclude(TissueResult& result) const noexcept {
  const bool full = (force_N_.array() > 0).count() == options_.contacts_max;
  result.contacts_left_out = pool_left_out_;
  for (int candidate = 0; full && candidate < pool_count_; ++candidate) {
    if (gap(candidate) < -tolerance_m_ && !is_working(candidate)) ++result.contacts_left_out;
  }
  result.converged = result.residual_m <= tolerance_m_;
  for (int k = 0; k < working_count_; ++k) {
    if (!(force_N_[k] > 0)) continue;
    const Pushed& one = pool_[working_[k]];
    // In the order in which put_into remembers them.
    result.push_N.at(static_cast<std::size_t>(result.contacts++)) = force_N_[k];
    result.force_N += force_N_[k] * (direction_ + one.aside_m / options_.radius_m);
  }
  if (result.contacts == 0) return;
  result.normal = result.force_N.stableNormalized();
  result.depth_m = pool_[deepest_at_rest()].depth_m;
  result.energy_J += 0.5 * force_N_.dot(compliance_ * force_N_);
}

void SphereContact::put_into(TissueState& state) const noexcept {
  state = {.started = 1,
           .contacts = 0,
           .probe_m = scene::to_array(probe_m_),
           .shift_m = {},
           .direction = scene::to_array(direction_),
           .contact = {}};
  for (int k = 0; k < working_count_; ++k) {
    if (force_N_[k] > 0) remember(working_[k], state);
  }
  if (pending_ >= 0) remember(pending_, state);
}

void SphereContact::remember(int candidate, TissueState& state) const noexcept {
  const SurfacePlace& place = pool_[candidate].place;
  state.contact[state.contacts++] = {place.triangle, scene::to_array(place.weight)};
}

TissueResult SphereContact::step(const Setting& setting, TissueState& state, const scene::Point& probe_m,
                                 const scene::Point& shift_m) noexcept {
  const TissueSurface& surface = setting.tissue.surface();
  Begin begin{.probe_m = probe_m, .shift_m = shift_m, .first = {}};
  scene::Point direction = scene::to_point(state.direction);
  if (state.contacts == 0) {
    const auto entered = came_in(surface, state, probe_m - shift_m);
    begin.first = entered ? *entered : surface.nearest(probe_m - shift_m).place;
    direction = direction_at(surface, begin.first, probe_m - shift_m);
  }
  SphereContact contact(setting, state, begin, direction);
  const TissueResult result = contact.solve_all();
  TissueState next = state;
  contact.put_into(next);
  if (result.contacts > 0 && contact.mean_normal().dot(direction) < kAligned) {
    SphereContact turned(setting, next, begin, contact.mean_normal());
    const TissueResult better = turned.solve_all();
    if (better.contacts > 0 && better.converged && better.energy_J <= result.energy_J) {
      turned.put_into(state);
      return better;
    }
    contact.load_others();
  }
  state = next;
  return result;
}

}  // namespace forcebound::tissue
