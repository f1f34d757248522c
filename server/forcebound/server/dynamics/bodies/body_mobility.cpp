#include "forcebound/server/dynamics/bodies/body_mobility.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "forcebound/server/dynamics/bodies/body_contacts.hpp"

namespace forcebound::server {
namespace {

// Each constraint this many times as hard as MuJoCo's: it gives way by a thousandth of what a free body does.
constexpr double kHard = 100;
// The weight of a contact that holds, of what its bodies weigh.
constexpr double kHardContact = 2000;
// A pivot below this share of the largest inertia is rounding.
constexpr double kNoInertia = 1e-12;
// A point that a force moves by less than this share of what it might is held.
constexpr double kHeld = 1e-4;
constexpr double kNothing_N = 1e-3;
// Estimates on a present-day machine.
constexpr double kMultiplication_ns = 0.7;
constexpr double kRayPastGeom_ns = 40;
constexpr double kRayThroughTriangle_ns = 10;
// Where a ray that comes back begins: before the surface that it leaves.
constexpr double kBefore_m = 1e-7;

double triangles_of(const mjModel& model, int geom) noexcept {
  const int data = model.geom_dataid[geom];
  if (data < 0) return 0;
  if (model.geom_type[geom] == mjGEOM_MESH) return model.mesh_facenum[data];
  if (model.geom_type[geom] != mjGEOM_HFIELD) return 0;
  return 2.0 * model.hfield_nrow[data] * model.hfield_ncol[data];
}

double hardness_kg(const mjModel& model, const mjContact& contact) noexcept {
  return kHardContact / (model.body_invweight0[2 * model.geom_bodyid[contact.geom1]] +
                         model.body_invweight0[2 * model.geom_bodyid[contact.geom2]]);
}

scene::Point normal_of(const mjContact& contact) noexcept { return Eigen::Map<const scene::Point>(contact.frame); }

scene::Point beside(const scene::Point& normal, const scene::Point& way) noexcept {
  return way - normal * normal.dot(way);
}

/// One of both stands still.
bool rubs_on_the_ground(const mjModel& model, const mjContact& contact) noexcept {
  return stands_still(model, model.geom_bodyid[contact.geom1]) || stands_still(model, model.geom_bodyid[contact.geom2]);
}

double square(double value) noexcept { return value * value; }

struct Hit {
  double away_m = -1;  // < 0: nothing
  int body = -1;
};

Hit look(const mjModel& model, const mjData& data, const scene::Point& from_m, const scene::Point& direction,
         int but_body) noexcept {
  constexpr mjtByte kStaticToo = 1;
  int geom = -1;
  const double away_m = mj_ray(&model, &data, from_m.data(), direction.data(), nullptr, kStaticToo, but_body, &geom);
  if (away_m < 0 || geom < 0) return {};
  return {.away_m = away_m, .body = model.geom_bodyid[geom]};
}

}  // namespace

bool BodyMobility::can_do(const mjModel_& model) noexcept { return model.nv > 0 && model.nv <= kDegreesMost; }

BodyMobility::BodyMobility(const mjModel_& model) {
  if (!can_do(model)) return;
  const auto degrees = static_cast<std::size_t>(model.nv);
  inertia_.resize(degrees * degrees);
  jacobian_.resize(3 * degrees);
  row_.resize(degrees);
  pulled_.resize(degrees);
  going_.resize(degrees);
  borne_.resize(degrees);
  loaded_.resize(degrees);
  apart_.resize(3 * degrees);
  of_first_.resize(3 * degrees);
  moved_.resize(3 * degrees);
  along_.resize(degrees);
}

double BodyMobility::predicted_cost_ns(const mjModel_& model) noexcept {
  if (!can_do(model)) return 0;
  const double degrees = model.nv;
  // Outer products of as many rows, a factorisation, and three solutions.
  return kMultiplication_ns * degrees * degrees * (degrees + degrees / 6 + 3);
}

void BodyMobility::read_row(const mjModel_& model, const mjData_& data, int row) noexcept {
  if (mj_isSparse(&model) != 0) {
    std::ranges::fill(row_, 0.0);
    const int begin = data.efc_J_rowadr[row];
    for (int k = begin; k < begin + data.efc_J_rownnz[row]; ++k)
      row_[static_cast<std::size_t>(data.efc_J_colind[k])] = data.efc_J[k];
  } else {
    std::copy_n(data.efc_J + static_cast<std::ptrdiff_t>(row) * model.nv, model.nv, row_.begin());
  }
}

bool BodyMobility::counts(const mjModel_& model, const mjContact_& contact) const noexcept {
  const auto is_of = [&](int body) { return body >= 0 && is_of_body(model, contact, body); };
  return std::ranges::none_of(contacts_.but_of, is_of);
}

void BodyMobility::hold(double weight_kg) noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (row_[i] == 0) continue;
    for (std::size_t k = 0; k < row_.size(); ++k) inertia_[i * row_.size() + k] += weight_kg * row_[i] * row_[k];
  }
}

/// How the second of two bodies moves from the first at their contact, in `apart_`.
void BodyMobility::look_at(const mjModel_& model, const mjData_& data, const mjContact_& contact) noexcept {
  mj_jac(&model, &data, apart_.data(), nullptr, contact.pos, model.geom_bodyid[contact.geom2]);
  mj_jac(&model, &data, of_first_.data(), nullptr, contact.pos, model.geom_bodyid[contact.geom1]);
  for (std::size_t i = 0; i < apart_.size(); ++i) apart_[i] -= of_first_[i];
}

/// Along its normal, and between two that move also along its surface, unless they slip.
void BodyMobility::hold(const mjModel_& model, const mjData_& data, const mjContact_& contact, bool slips) noexcept {
  look_at(model, data, contact);
  for (int axis = 0; axis < (slips || rubs_on_the_ground(model, contact) ? 1 : 3); ++axis) {
    mju_mulMatTVec(row_.data(), apart_.data(), contact.frame + 3 * axis, 3, model.nv);
    hold(hardness_kg(model, contact));
  }
}

bool BodyMobility::consider(const mjModel_& model, const mjData_& data, const Contacts& contacts) noexcept {
  if (row_.empty()) return false;
  contacts_ = contacts;
  contacts_.contacts = contacts.contacts.first(std::min(contacts.contacts.size(), slips_.size()));
  slips_.fill(false);
  return factor(model, data);
}

bool BodyMobility::factor(const mjModel_& model, const mjData_& data) noexcept {
  mj_fullM(&model, inertia_.data(), data.qM);
  mju_copy(going_.data(), data.qvel, model.nv);
  mju_mulMatVec(pulled_.data(), inertia_.data(), going_.data(), model.nv, model.nv);
  for (int row = 0; row < data.nefc; ++row) {
    if (data.efc_type[row] != mjCNSTR_EQUALITY) continue;
    read_row(model, data, row);
    hold(kHard * data.efc_D[row]);
  }
  for (std::size_t i = 0; i < contacts_.contacts.size(); ++i) {
    const mjContact& contact = contacts_.contacts[i];
    if (counts(model, contact)) hold(model, data, contact, slips_.at(i));
  }
  const double smallest = kNoInertia * *std::ranges::max_element(inertia_);
  if (mju_cholFactor(inertia_.data(), model.nv, smallest) != model.nv) return false;
  mju_cholSolve(going_.data(), inertia_.data(), pulled_.data(), model.nv);
  return true;
}

/// At the contact looked at, by motions of the joints.
scene::Point BodyMobility::apart(const std::vector<double>& joints) const noexcept {
  scene::Point moved;
  mju_mulMatVec(moved.data(), apart_.data(), joints.data(), 3, static_cast<int>(joints.size()));
  return moved;
}

/// What presses both bodies of the contact looked at together: the forces that bear what pulls and pushes at them, and
/// not those of one step, in which a body that rests trembles.
double BodyMobility::bearing_N(const mjModel_& model, const mjContact_& contact) const noexcept {
  return -hardness_kg(model, contact) * normal_of(contact).dot(apart(borne_));
}

/// Of contacts that slide while the point moves along the direction.
double BodyMobility::dry_friction_N(const mjModel_& model, const mjData_& data, const scene::Point& pushed_N) noexcept {
  mju_mulMatTVec(pulled_.data(), jacobian_.data(), pushed_N.data(), 3, model.nv);
  mju_addTo(pulled_.data(), data.qfrc_smooth, model.nv);
  mju_cholSolve(borne_.data(), inertia_.data(), pulled_.data(), model.nv);
  double sum_N = 0;
  for (std::size_t i = 0; i < contacts_.contacts.size(); ++i) {
    const mjContact& contact = contacts_.contacts[i];
    if (!counts(model, contact) || !(slips_.at(i) || rubs_on_the_ground(model, contact))) continue;
    look_at(model, data, contact);
    sum_N += contact.friction[0] * bearing_N(model, contact) * beside(normal_of(contact), apart(along_)).norm();
  }
  return std::max(0.0, sum_N);
}

/// Which contacts between two that move slip: those whose friction does not bear what the friction elsewhere asks of
/// them, while the point is pushed until that gives way. @return whether some more do
bool BodyMobility::find_slips(const mjModel_& model, const mjData_& data, double pushed_N) noexcept {
  const scene::Point push_N = pushed_N * way_;
  mju_mulMatTVec(pulled_.data(), jacobian_.data(), push_N.data(), 3, model.nv);
  for (const mjContact& contact : contacts_.contacts) {
    if (!counts(model, contact) || !rubs_on_the_ground(model, contact)) continue;
    look_at(model, data, contact);
    const scene::Point slides = beside(normal_of(contact), apart(along_));
    if (!(slides.norm() > kHeld)) continue;
    // On the second, and as much on the first the other way.
    const scene::Point rubs_N = -contact.friction[0] * bearing_N(model, contact) * slides.normalized();
    mju_mulMatTVec(row_.data(), apart_.data(), rubs_N.data(), 3, model.nv);
    mju_addTo(pulled_.data(), row_.data(), model.nv);
  }
  mju_cholSolve(loaded_.data(), inertia_.data(), pulled_.data(), model.nv);
  bool more = false;
  for (std::size_t i = 0; i < contacts_.contacts.size(); ++i) {
    const mjContact& contact = contacts_.contacts[i];
    if (!counts(model, contact) || slips_.at(i) || rubs_on_the_ground(model, contact)) continue;
    look_at(model, data, contact);
    const scene::Point asked = beside(normal_of(contact), apart(loaded_));
    const double most_N = contact.friction[0] * std::max(0.0, bearing_N(model, contact));
    slips_.at(i) = hardness_kg(model, contact) * asked.norm() > most_N + kNothing_N;
    more = more || slips_.at(i);
  }
  return more;
}

std::optional<local_model::Body> BodyMobility::answer(const mjModel_& model, const mjData_& data, int body,
                                                      const scene::Point& at_m, const scene::Point& direction,
                                                      const scene::Point& pushed_N) noexcept {
  if (std::ranges::find(slips_, true) != slips_.end()) {
    slips_.fill(false);
    if (!factor(model, data)) return std::nullopt;
  }
  const auto as_held = answer_once(model, data, body, at_m, direction, pushed_N);
  if (!as_held || !find_slips(model, data, as_held->dry_friction_N)) return as_held;
  if (!factor(model, data)) return std::nullopt;
  return answer_once(model, data, body, at_m, direction, pushed_N);
}

std::optional<local_model::Body> BodyMobility::answer_once(const mjModel_& model, const mjData_& data, int body,
                                                           const scene::Point& at_m, const scene::Point& direction,
                                                           const scene::Point& pushed_N) noexcept {
  using Row = Eigen::Map<const Eigen::VectorXd>;
  using Rows = Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>;
  mj_jac(&model, &data, jacobian_.data(), nullptr, at_m.data(), body);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    mju_cholSolve(moved_.data() + axis * model.nv, inertia_.data(), jacobian_.data() + axis * model.nv, model.nv);
  const Rows jacobian(jacobian_.data(), 3, model.nv);
  const Rows moved(moved_.data(), 3, model.nv);
  local_model::Body found;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    found.velocity_m_per_s[axis] = jacobian.row(axis).dot(Row(going_.data(), model.nv));
    found.bias_m_per_s2[axis] = moved.row(axis).dot(Row(data.qfrc_smooth, model.nv));
    for (Eigen::Index other = 0; other < 3; ++other)
      found.mobility_per_kg(other, axis) = jacobian.row(other).dot(moved.row(axis));
  }
  found.mobility_per_kg = Eigen::Matrix3d(0.5 * (found.mobility_per_kg + found.mobility_per_kg.transpose()));
  if (!found.mobility_per_kg.allFinite() || !found.bias_m_per_s2.allFinite()) return std::nullopt;
  Eigen::Index easiest = 0;
  const double most_per_kg = found.mobility_per_kg.diagonal().maxCoeff(&easiest);
  const scene::Point way =
      direction.isZero(0) ? scene::Point(found.mobility_per_kg.col(easiest).normalized()) : direction;
  const double along_per_kg = way.dot(found.mobility_per_kg * way);
  std::ranges::fill(along_, 0.0);
  way_.setZero();
  if (!(along_per_kg > kHeld * most_per_kg)) return found;
  const scene::Point by = way / along_per_kg;
  mju_mulMatTVec(along_.data(), moved_.data(), by.data(), 3, model.nv);
  for (int joint = 0; joint < model.njnt; ++joint) {
    const int first = model.jnt_dofadr[joint];
    for (int degree = first; degree < model.nv && model.dof_jntid[degree] == joint; ++degree)
      found.spring_N_per_m += model.jnt_stiffness[joint] * square(along_[static_cast<std::size_t>(degree)]);
  }
  for (int degree = 0; degree < model.nv; ++degree) {
    const double share = along_[static_cast<std::size_t>(degree)];
    found.damper_N_s_per_m += model.dof_damping[degree] * square(share);
    found.dry_friction_N += model.dof_frictionloss[degree] * std::abs(share);
  }
  found.dry_friction_N += dry_friction_N(model, data, pushed_N);
  // Dampers are those of `damper_N_s_per_m`.
  found.bias_m_per_s2 += found.damper_N_s_per_m * found.mobility_per_kg * found.velocity_m_per_s;
  way_ = way;
  return found;
}

BodyMobility::Room BodyMobility::room_of_joints_m(const mjModel_& model, const mjData_& data) const noexcept {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  Room room{.way = way_, .along_m = kNoLimit, .against_m = kNoLimit};
  for (int joint = 0; joint < model.njnt; ++joint) {
    const int type = model.jnt_type[joint];
    if (model.jnt_limited[joint] == 0 || (type != mjJNT_SLIDE && type != mjJNT_HINGE)) continue;
    const double share = along_[static_cast<std::size_t>(model.jnt_dofadr[joint])];
    if (share == 0) continue;
    const double at = data.qpos[model.jnt_qposadr[joint]];
    const double down_m = std::max(0.0, at - model.jnt_range[2 * joint]) / std::abs(share);
    const double up_m = std::max(0.0, model.jnt_range[2 * joint + 1] - at) / std::abs(share);
    room.along_m = std::min(room.along_m, share > 0 ? up_m : down_m);
    room.against_m = std::min(room.against_m, share > 0 ? down_m : up_m);
  }
  return room;
}

double travel_m(const mjModel_& model, const mjData_& data, int body, const scene::Point& direction) noexcept {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  const scene::Point center_m = Eigen::Map<const scene::Point>(data.xipos + 3 * body);
  const Hit obstacle = look(model, data, center_m, direction, body);
  if (obstacle.away_m < 0 || model.body_weldid[obstacle.body] != 0) return kNothing;
  // Back from there: how much room there is before the body's own surface.
  const double back_m = std::max(0.0, obstacle.away_m - kBefore_m);
  const scene::Point surface_m = center_m + back_m * direction;
  const scene::Point back = -direction;
  const Hit own = look(model, data, surface_m, back, obstacle.body);
  if (own.away_m < 0 || own.body != body) return kNothing;
  // Beyond its centre is its far side: the body is in the obstacle already, as deep as a contact gives way.
  return own.away_m > back_m ? 0 : own.away_m;
}

double predicted_travel_cost_ns(const mjModel_& model) noexcept {
  double ray_ns = 0;
  for (int geom = 0; geom < model.ngeom; ++geom)
    ray_ns += kRayPastGeom_ns + kRayThroughTriangle_ns * triangles_of(model, geom);
  return 2 * ray_ns;
}

}  // namespace forcebound::server
