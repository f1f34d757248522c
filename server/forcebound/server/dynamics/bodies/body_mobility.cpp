#include "forcebound/server/dynamics/bodies/body_mobility.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace forcebound::server {
namespace {

// Each constraint this many times as hard as MuJoCo's: it gives way by a thousandth of what a free body does.
constexpr double kHard = 100;
// A pivot below this share of the largest inertia is rounding.
constexpr double kNoInertia = 1e-12;
// Estimates on a present-day machine.
constexpr double kMultiplication_ns = 0.7;
constexpr double kRayPastGeom_ns = 40;
constexpr double kRayThroughTriangle_ns = 10;
// Where a ray that comes back begins: before the surface that it leaves.
constexpr double kBefore_m = 1e-7;

/// Whether a row of the constraints acted like a spring in the last step. Of a sliding elliptic contact its normal did.
bool acted(const mjData& data, int row) noexcept {
  if (data.efc_state[row] == mjCNSTRSTATE_QUADRATIC) return true;
  if (data.efc_state[row] != mjCNSTRSTATE_CONE) return false;
  const int contact = data.efc_id[row];
  return contact >= 0 && contact < data.ncon && data.contact[contact].efc_address == row;
}

double triangles_of(const mjModel& model, int geom) noexcept {
  const int data = model.geom_dataid[geom];
  if (data < 0) return 0;
  if (model.geom_type[geom] == mjGEOM_MESH) return model.mesh_facenum[data];
  if (model.geom_type[geom] != mjGEOM_HFIELD) return 0;
  return 2.0 * model.hfield_nrow[data] * model.hfield_ncol[data];
}

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
  moved_.resize(degrees);
}

double BodyMobility::predicted_cost_ns(const mjModel_& model) noexcept {
  if (!can_do(model)) return 0;
  const double degrees = model.nv;
  // The constraints' outer products, a factorisation, and three solutions.
  return kMultiplication_ns * degrees * degrees * (degrees + degrees / 6 + 3);
}

bool BodyMobility::is_constrained(const mjData_& data) noexcept {
  for (int row = 0; row < data.nefc; ++row) {
    if (acted(data, row)) return true;
  }
  return false;
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

bool BodyMobility::factor(const mjModel_& model, const mjData_& data, With constraints) noexcept {
  if (row_.empty()) return false;
  mj_fullM(&model, inertia_.data(), data.qM);
  std::copy_n(data.qfrc_smooth, model.nv, pulled_.begin());
  for (int row = 0; constraints != With::none && row < data.nefc; ++row) {
    if (!acted(data, row) || (constraints == With::equalities && data.efc_type[row] != mjCNSTR_EQUALITY)) continue;
    read_row(model, data, row);
    const double weight_kg = kHard * data.efc_D[row];
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (row_[i] == 0) continue;
      pulled_[i] += weight_kg * row_[i] * data.efc_aref[row];
      for (std::size_t k = 0; k < row_.size(); ++k) inertia_[i * row_.size() + k] += weight_kg * row_[i] * row_[k];
    }
  }
  const double smallest = kNoInertia * *std::ranges::max_element(inertia_);
  return mju_cholFactor(inertia_.data(), model.nv, smallest) == model.nv;
}

std::optional<Eigen::Matrix3d> BodyMobility::per_kg(const mjModel_& model, const mjData_& data, int body,
                                                    With constraints) noexcept {
  if (!factor(model, data, constraints)) return std::nullopt;
  mj_jacBodyCom(&model, &data, jacobian_.data(), nullptr, body);
  using Row = Eigen::Map<const Eigen::VectorXd>;
  Eigen::Matrix3d mobility;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    mju_cholSolve(moved_.data(), inertia_.data(), jacobian_.data() + axis * model.nv, model.nv);
    for (Eigen::Index other = 0; other < 3; ++other)
      mobility(other, axis) = Row(jacobian_.data() + other * model.nv, model.nv).dot(Row(moved_.data(), model.nv));
  }
  if (!mobility.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(0.5 * (mobility + mobility.transpose()));
}

scene::Point BodyMobility::acceleration_m_per_s2(const mjModel_& model, const mjData_& data, int body,
                                                 With constraints) noexcept {
  scene::Point acceleration = scene::Point::Zero();
  if (row_.empty()) return acceleration;
  const double* joints = constraints == With::all ? data.qacc : data.qacc_smooth;
  if (constraints == With::equalities && factor(model, data, constraints)) {
    mju_cholSolve(moved_.data(), inertia_.data(), pulled_.data(), model.nv);
    joints = moved_.data();
  }
  mj_jacBodyCom(&model, &data, jacobian_.data(), nullptr, body);
  using Row = Eigen::Map<const Eigen::VectorXd>;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    acceleration[axis] = Row(jacobian_.data() + axis * model.nv, model.nv).dot(Row(joints, model.nv));
  return acceleration;
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
