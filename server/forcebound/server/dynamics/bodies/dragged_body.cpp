#include "forcebound/server/dynamics/bodies/dragged_body.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "forcebound/local_model/no_longer_than.hpp"
#include "forcebound/server/dynamics/bodies/body_contacts.hpp"

namespace forcebound::server {
namespace {

using local_model::Contact;
using local_model::Mass;
using scene::Point;

// Of a local model: the most that gravity and joints do to a body.
constexpr double kBias_m_per_s2_most = 1000;
// Contacts of two geometries with normals this close to each other are one.
constexpr double kSameWay = 0.9;
// What is round is flat for so far, and a normal this much along an axis of a box is that of its face.
constexpr double kRound_m = 0.005;
constexpr double kFlat = 0.999;
// Of an acceleration.
constexpr double kRoundingShare = 1e-9;
// Time constant of a joint's stop.
constexpr double kStop_s = 0.01;
// Of a mass in the scene, for devices so far from it.
constexpr double kRadius_m = 2 * Mass::kReachMost_m;
// Estimate on a present-day machine, beside answers and ways.
constexpr double kDescribe_ns = 2000;

/// A contact of the dragged body that is to be told.
struct Near {
  int met = 0;
  scene::Point at_m = scene::Point::Zero();
  Contact contact{};
  int count = 1;  // of MuJoCo's contacts that it stands for
};

/// MuJoCo's impedance at a depth (its manual, "Solver parameters"), with bounds as MuJoCo has them.
double impedance(const mjtNum* solimp, double distance_m) noexcept {
  const auto share = [](double value) { return std::clamp<double>(value, mjMINIMP, mjMAXIMP); };
  const double least = share(solimp[0]);
  const double most = share(solimp[1]);
  const double width_m = std::max<double>(mjMINVAL, solimp[2]);
  const double middle = share(solimp[3]);
  const double power = std::max<double>(1, solimp[4]);
  const double way = std::min(1.0, std::abs(distance_m) / width_m);
  const double eased = way <= middle ? std::pow(way, power) / std::pow(middle, power - 1)
                                     : 1 - std::pow(1 - way, power) / std::pow(1 - middle, power - 1);
  return least + eased * (most - least);
}

/// As MuJoCo makes a contact's reference acceleration and regularisation of its parameters.
Contact contact_of(const mjModel& model, const mjContact& contact) noexcept {
  const double depth_m = std::min<double>(0, contact.dist - contact.includemargin);
  const double share = impedance(contact.solimp, depth_m);
  const double most = std::clamp<double>(contact.solimp[1], mjMINIMP, mjMAXIMP);
  double stiffness_per_s2 = -contact.solref[0] / (most * most);
  double damping_per_s = -contact.solref[1] / most;
  if (contact.solref[0] > 0) {
    const double time_s = std::max<double>(contact.solref[0], 2 * model.opt.timestep);
    stiffness_per_s2 = 1 / std::pow(most * time_s * contact.solref[1], 2);
    damping_per_s = 2 / (most * time_s);
  }
  const double bodies_per_kg = model.body_invweight0[2 * model.geom_bodyid[contact.geom1]] +
                               model.body_invweight0[2 * model.geom_bodyid[contact.geom2]];
  return {.gap_m = contact.dist - contact.includemargin,
          .compliance_per_kg = (1 - share) / share * bodies_per_kg,
          .stiffness_per_s2 = share * stiffness_per_s2,
          .damping_per_s = damping_per_s,
          .friction = contact.friction[0]};
}

/// How far along its surface a geometry goes on as it is at a point: a plane for ever, a box to the edge of its face,
/// and what is round or pointed hardly farther than it is away.
double goes_on_m(const mjModel& model, const mjData& data, int geom, const mjContact& contact) noexcept {
  if (model.geom_type[geom] == mjGEOM_PLANE) return std::numeric_limits<double>::infinity();
  const double about_m = kRound_m + std::max<double>(0, contact.dist);
  if (model.geom_type[geom] != mjGEOM_BOX) return about_m;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turned(data.geom_xmat + 9 * geom);
  const Eigen::Map<const Point> center_m(data.geom_xpos + 3 * geom);
  const Point normal = turned.transpose() * Eigen::Map<const Point>(contact.frame);
  const Point at_m = turned.transpose() * (Eigen::Map<const Point>(contact.pos) - center_m);
  Eigen::Index face = 0;
  if (normal.cwiseAbs().maxCoeff(&face) < kFlat) return about_m;
  double least_m = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis != face) least_m = std::min(least_m, model.geom_size[3 * geom + axis] - std::abs(at_m[axis]));
  }
  return std::max(least_m, kRound_m);
}

/// As MuJoCo makes the parameters of a contact of those of its geometries (its manual, "Contact parameters").
void mix(const mjModel& model, int first, int second, mjContact& contact) noexcept {
  contact.geom1 = first;
  contact.geom2 = second;
  contact.includemargin = 0;
  const int before = model.geom_priority[first] - model.geom_priority[second];
  const double weights = model.geom_solmix[first] + model.geom_solmix[second];
  const double share = before > 0 ? 1 : before < 0 ? 0 : weights > mjMINVAL ? model.geom_solmix[first] / weights : 0.5;
  const auto mixed = [share](double one, double other) { return share * one + (1 - share) * other; };
  const mjtNum* const ref = model.geom_solref + mjNREF * first;
  const mjtNum* const other_ref = model.geom_solref + mjNREF * second;
  const bool in_time = before != 0 || (ref[0] > 0 && other_ref[0] > 0);
  for (int i = 0; i < mjNREF; ++i)
    contact.solref[i] = in_time ? mixed(ref[i], other_ref[i]) : std::min(ref[i], other_ref[i]);
  for (int i = 0; i < mjNIMP; ++i)
    contact.solimp[i] = mixed(model.geom_solimp[mjNIMP * first + i], model.geom_solimp[mjNIMP * second + i]);
  const double friction = model.geom_friction[3L * first];
  const double other_friction = model.geom_friction[3L * second];
  contact.friction[0] = before == 0 ? std::max(friction, other_friction) : mixed(friction, other_friction);
}

/// Whether two geometries touch at all, and are near enough.
bool may_meet(const mjModel& model, const mjData& data, int one, int other) noexcept {
  const bool collide = (model.geom_contype[one] & model.geom_conaffinity[other]) != 0 ||
                       (model.geom_contype[other] & model.geom_conaffinity[one]) != 0;
  if (!collide) return false;
  if (model.geom_rbound[one] == 0 || model.geom_rbound[other] == 0) return true;  // a plane
  const double away_m = mju_dist3(data.geom_xpos + 3L * one, data.geom_xpos + 3L * other);
  return away_m < model.geom_rbound[one] + model.geom_rbound[other] + DraggedBodies::kNear_m;
}

/// The nearest, at most as many as a mass can have, with one for each body that moves.
class Nearest {
 public:
  void add(const mjModel& model, const Near& near) noexcept {
    const bool moves = !stands_still(model, near.met);
    for (Near& other : std::span(near_).first(count_)) {
      const bool same_way = near.contact.normal.dot(other.contact.normal) > kSameWay;
      if (other.met != near.met || !(moves || same_way)) continue;
      const bool together = same_way && near.contact.gap_m < 0 && other.contact.gap_m < 0;
      const int count = other.count;
      if (near.contact.gap_m < other.contact.gap_m) other = near;
      other.count = together ? count + 1 : other.count;
      return;
    }
    if (count_ < near_.size()) {
      near_.at(count_++) = near;
      return;
    }
    Near& farthest = *std::ranges::max_element(near_, {}, [](const Near& one) { return one.contact.gap_m; });
    if (near.contact.gap_m < farthest.contact.gap_m) farthest = near;
  }

  [[nodiscard]] std::span<Near> all() noexcept { return std::span(near_).first(count_); }

 private:
  std::array<Near, Mass::kContactsMax> near_{};
  std::size_t count_ = 0;
};

void add(const mjModel& model, const mjData& data, const DraggedBody& dragged, const mjContact& contact,
         Nearest& nearest) noexcept {
  const int first = model.geom_bodyid[contact.geom1];
  const int second = model.geom_bodyid[contact.geom2];
  const auto is_dragged = [&](int body) { return body == dragged.body || body == dragged.held; };
  if (is_dragged(first) == is_dragged(second)) return;
  Near near{.met = is_dragged(first) ? second : first, .contact = contact_of(model, contact)};
  near.contact.radius_m = goes_on_m(model, data, is_dragged(first) ? contact.geom2 : contact.geom1, contact);
  // A contact's normal is out of its first geom.
  near.contact.normal = (is_dragged(first) ? -1 : 1) * Eigen::Map<const scene::Point>(contact.frame);
  // A contact's place is half way between both.
  near.at_m = Eigen::Map<const Point>(contact.pos) - 0.5 * contact.dist * near.contact.normal;
  nearest.add(model, near);
}

/// Of those that MuJoCo lists, of those ahead, and of those that acted shortly before: they will again.
Nearest nearest_of(const mjModel& model, const mjData& data, const DraggedBody& dragged,
                   std::span<const mjContact> ahead, std::span<const mjContact> recent) noexcept {
  Nearest nearest;
  const std::span listed(data.contact, static_cast<std::size_t>(data.ncon));
  for (const mjContact& contact : ahead) add(model, data, dragged, contact, nearest);
  for (const mjContact& contact : listed) add(model, data, dragged, contact, nearest);
  for (mjContact contact : recent) {
    const auto is_listed = [&](const mjContact& one) {
      return one.geom1 == contact.geom1 && one.geom2 == contact.geom2;
    };
    if (std::ranges::any_of(listed, is_listed) || std::ranges::any_of(ahead, is_listed)) continue;
    contact.dist = contact.includemargin;
    add(model, data, dragged, contact, nearest);
  }
  return nearest;
}

void bound(local_model::Body& body) noexcept {
  body.bias_m_per_s2 = local_model::no_longer_than(body.bias_m_per_s2, kBias_m_per_s2_most);
}

}  // namespace

DraggedBodies::DraggedBodies(const mjModel_& model, const Coupling& coupling)
    : coupling_(coupling), mobility_(model), found_(mjMAXCONPAIR) {
  ahead_.reserve(kAheadMost);
}

/// What MuJoCo does not list yet: as its own collision would find it, each geometry with each other.
void DraggedBodies::look_ahead(const mjModel_& model, const mjData_& data, const DraggedBody& dragged) noexcept {
  ahead_.clear();
  for (int own = 0; own < model.ngeom; ++own) {
    if (model.geom_bodyid[own] != dragged.body && model.geom_bodyid[own] != dragged.held) continue;
    for (int other = 0; other < model.ngeom && ahead_.size() < kAheadMost; ++other) {
      const int body = model.geom_bodyid[other];
      if (body == dragged.body || body == dragged.held || !may_meet(model, data, own, other)) continue;
      const bool in_order = model.geom_type[own] <= model.geom_type[other];
      const int first = in_order ? own : other;
      const int second = in_order ? other : own;
      const mjfCollision collide = mjCOLLISIONFUNC[model.geom_type[first]][model.geom_type[second]];
      if (collide == nullptr) continue;
      const int count = collide(&model, &data, found_.data(), first, second, kNear_m);
      const auto found = std::span(found_).first(static_cast<std::size_t>(std::max(0, count)));
      const auto nearest = std::ranges::min_element(found, {}, [](const mjContact& one) { return one.dist; });
      if (nearest == found.end() || !(nearest->dist > 0)) continue;
      ahead_.push_back(*nearest);
      mix(model, first, second, ahead_.back());
    }
  }
}

std::optional<local_model::Mass> DraggedBodies::describe(const mjModel_& model, const mjData_& data,
                                                         const DraggedBody& dragged) noexcept {
  recent_.update(model, data);
  look_ahead(model, data, dragged);
  if (!mobility_.consider(model, data, {})) return std::nullopt;
  const scene::Point center_m = Eigen::Map<const scene::Point>(data.xipos + 3 * dragged.body);
  const auto own = mobility_.answer(model, data, dragged.body, center_m, scene::Point::Zero(), scene::Point::Zero());
  if (!own || !(own->mobility_per_kg.trace() > 0)) return std::nullopt;
  Mass mass{.force_N = dragged.force_N,
            .stiffness_N_per_m = coupling_.stiffness_N_per_m,
            .damping_N_s_per_m = coupling_.damping_N_s_per_m,
            .body = *own,
            .radius_m = kRadius_m};
  // Less the coupling's own force, which is -force_N on it. Where nothing else pulls only rounding is left.
  const Point coupling_m_per_s2 = own->mobility_per_kg * dragged.force_N;
  mass.body.bias_m_per_s2 += coupling_m_per_s2;
  if (mass.body.bias_m_per_s2.norm() <= kRoundingShare * coupling_m_per_s2.norm()) mass.body.bias_m_per_s2.setZero();
  bound(mass.body);
  mass.place_m = center_m + dragged.since_s * mass.body.velocity_m_per_s;
  Nearest nearest = nearest_of(model, data, dragged, ahead_, recent_.all());
  const BodyMobility::Room room = mobility_.room_of_joints_m(model, data);
  for (const bool along : {true, false}) {
    const double room_m = along ? room.along_m : room.against_m;
    if (!(room_m < kNear_m)) continue;
    nearest.add(model, {.contact = {.normal = along ? scene::Point(-room.way) : room.way,
                                    .gap_m = room_m,
                                    .stiffness_per_s2 = 1 / (kStop_s * kStop_s),
                                    .damping_per_s = 2 / kStop_s}});
  }
  // What stands still takes fewer bytes at the end.
  const std::span<Near> told = nearest.all();
  const auto still =
      std::partition(told.begin(), told.end(), [&](const Near& near) { return !stands_still(model, near.met); });
  const bool gives_way = still != told.begin();
  const bool solved =
      gives_way && mobility_.consider(model, data, {.contacts = recent_.all(), .but_of = {dragged.body, dragged.held}});
  for (Near& near : told) {
    Contact& contact = near.contact;
    if (!stands_still(model, near.met)) {
      const scene::Point pushed = -contact.normal;
      const bool touches = contact.gap_m < 0;
      const scene::Point pushed_N =
          touches ? Point(std::max(0.0, -dragged.force_N.dot(pushed)) * pushed) : Point(Point::Zero());
      const auto met = solved ? mobility_.answer(model, data, near.met, near.at_m, pushed, pushed_N) : std::nullopt;
      if (!met) return std::nullopt;
      contact.met = *met;
      bound(contact.met);
      const BodyMobility::Room of_joints = mobility_.room_of_joints_m(model, data);
      contact.travel_m = std::min(of_joints.along_m, travel_m(model, data, near.met, pushed));
      contact.return_m = of_joints.against_m;
    }
    contact.compliance_per_kg /= near.count;
    contact.gap_m += dragged.since_s * contact.normal.dot(mass.body.velocity_m_per_s - contact.met.velocity_m_per_s);
    mass.contacts.at(mass.contact_count++) = contact;
  }
  return mass;
}

double DraggedBodies::predicted_cost_ns(const mjModel_& model) noexcept {
  if (!BodyMobility::can_do(model)) return 0;
  return kDescribe_ns + 2 * BodyMobility::predicted_cost_ns(model) +
         Mass::kContactsMax * predicted_travel_cost_ns(model);
}

}  // namespace forcebound::server
