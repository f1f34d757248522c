#include "forcebound/server/dynamics/bodies/body_world.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "forcebound/local_model/no_longer_than.hpp"
#include "forcebound/server/dynamics/bodies/body_contacts.hpp"
#include "forcebound/server/dynamics/bodies/description.hpp"
#include "forcebound/server/dynamics/bodies/visible_geometries.hpp"

namespace forcebound::server {
namespace {

constexpr int kStepsMax = 50;
constexpr double kReachMost_m = local_model::Mass::kReachMost_m;
constexpr double kVelocityHeld_s = 0.01;
// A position farther away comes from a faulty or hostile client and must not disturb other clients.
constexpr double kFar_m = 100;
// Least time in which the coupling reaches the device: longer than a hand's reaction time.
constexpr double kArrival_s_min = 0.5;
constexpr double kArrival_m_per_s_max = 0.6;
// How often a ball that begins inside bodies is pushed out of the deepest one, and the depth that is ignored.
constexpr int kPushesMax = 8;
constexpr double kWithin_m = 1e-6;
// A blow on what is held lasts for less.
constexpr double kOverload_s_most = 0.02;

// A force on a body acts at its centre of mass: only with that point's own position and velocity does the coupling
// return no more energy than it took.
scene::Point position_of(const mjData& data, int body) noexcept {
  return Eigen::Map<const scene::Point>(data.xipos + 3 * body);
}

scene::Point velocity_of(const mjModel& model, const mjData& data, int body) noexcept {
  mjtNum velocity[6];
  mj_objectVelocity(&model, &data, mjOBJ_BODY, body, velocity, 0);
  return {velocity[3], velocity[4], velocity[5]};
}

}  // namespace

BodyWorld::BodyWorld(ModelPointer model, const Coupling& coupling, const std::vector<Probe>& probes,
                     const std::optional<GraspDescription>& grasp)
    : model_(std::move(model)),
      data_(make_data(*model_)),
      coupling_(coupling),
      grasp_(grasp),
      describer_(*model_, coupling) {
  seats_.reserve(probes.size());
  for (const Probe& probe : probes) {
    seats_.push_back({probe});
    park(static_cast<int>(seats_.size()) - 1);
  }
  forward(*model_, *data_);
  visible_ = visible_geometries(*model_, balls(), false);
}

std::vector<int> BodyWorld::balls() const {
  std::vector<int> bodies;
  for (const Seat& seat : seats_) {
    if (seat.slides >= 0) bodies.push_back(seat.body);
  }
  return bodies;
}

std::vector<scene::VisiblePart> BodyWorld::visible() const {
  std::vector<scene::VisiblePart> parts;
  for (const int geometry : visible_) parts.push_back(part_of(*model_, *data_, geometry));
  for (const int plane : visible_geometries(*model_, balls(), true)) {
    parts.push_back(part_of(*model_, *data_, plane));
  }
  return parts;
}

std::size_t BodyWorld::sample(std::size_t first, std::span<float> to) const noexcept {
  if (first >= visible_.size()) return 0;
  const std::size_t count = std::min(visible_.size() - first, to.size() / scene::kNumbersOfSolid);
  for (std::size_t i = 0; i < count; ++i) {
    put_place(*data_, visible_[first + i], to.subspan(i * scene::kNumbersOfSolid).data());
  }
  return count * scene::kNumbersOfSolid;
}

int BodyWorld::join() {
  const auto free = std::find_if(seats_.begin(), seats_.end(), [](const Seat& seat) { return !seat.taken; });
  if (free == seats_.end()) return -1;
  free->taken = true;
  return static_cast<int>(free - seats_.begin());
}

void BodyWorld::leave(int seat) {
  park(seat);
  seats_[static_cast<std::size_t>(seat)].taken = false;
}

void BodyWorld::press(int seat, std::uint32_t buttons) noexcept {
  Seat& pressing = seats_[static_cast<std::size_t>(seat)];
  pressing.pressed = grasp_ && ((buttons >> static_cast<unsigned>(grasp_->button)) & 1U) != 0;
}

void BodyWorld::park(int seat) noexcept {
  Seat& parked = seats_[static_cast<std::size_t>(seat)];
  let_go(parked);
  parked.pressed = false;
  parked.slipped = false;
  parked.placed = false;
  parked.force_N.setZero();
  parked.pushed_m.setZero();
  if (parked.slides >= 0) place(parked, parking_m(seat));
  Eigen::Map<scene::Point>(data_->xfrc_applied + 6 * parked.body) = bearing_N(parked);
}

void BodyWorld::place(const Probe& ball, const scene::Point& position_m) noexcept {
  // Slides begin at the origin, where their body is.
  for (int axis = 0; axis < 3; ++axis) data_->qpos[ball.slides + axis] = position_m[axis];
  const int velocities = model_->jnt_dofadr[model_->body_jntadr[ball.body]];
  mju_zero(data_->qvel + velocities, 3);
}

void BodyWorld::place_outside(const Probe& ball, scene::Point position_m) noexcept {
  for (int i = 0; i <= kPushesMax; ++i) {
    place(ball, position_m);
    sound_ = sound_ && find_contacts(*model_, *data_);
    const mjContact* deepest = nullptr;
    for (int at = 0; at < data_->ncon; ++at) {
      const mjContact& contact = data_->contact[at];
      if (touches(*model_, contact, ball.body) && (deepest == nullptr || contact.dist < deepest->dist)) {
        deepest = &contact;
      }
    }
    if (deepest == nullptr || deepest->dist > -kWithin_m) return;
    // A contact's normal is out of its first geom.
    const double out = model_->geom_bodyid[deepest->geom2] == ball.body ? 1 : -1;
    position_m -= out * deepest->dist * Eigen::Map<const scene::Point>(deepest->frame);
  }
}

void BodyWorld::appear(Seat& seat) noexcept {
  seat.placed = true;
  seat.placed_s = 0;
  if (seat.slides >= 0) place_outside(seat, seat.device_m);
  seat.begins_aside_m = position_of(*data_, seat.body) - seat.device_m;
  // The way eased at both ends is fastest half way, at 3/2 of its mean speed.
  seat.arrival_s = std::max(kArrival_s_min, 1.5 * seat.begins_aside_m.norm() / kArrival_m_per_s_max);
}

void BodyWorld::move(int at, const scene::Point& position_m, const scene::Point& velocity_m_per_s) noexcept {
  Seat& seat = seats_[static_cast<std::size_t>(at)];
  seat.device_m = local_model::no_longer_than(position_m, kFar_m);
  seat.device_m_per_s = local_model::no_longer_than(velocity_m_per_s, local_model::Mass::kSpeedMost_m_per_s);
  seat.heard = true;
  seat.unmoved_s = 0;
  if (!seat.placed) appear(seat);
}

void BodyWorld::advance(double elapsed_s) noexcept {
  if (!sound_) return;
  left_s_ += elapsed_s;
  const double step_s = model_->opt.timestep;
  // Rounding must not lose a step.
  const double steps_due = std::floor(left_s_ / step_s + 1e-6);
  const int steps = static_cast<int>(std::min<double>(steps_due, kStepsMax));
  for (int i = 1; i <= steps && sound_; ++i) step_once((steps - i) * step_s);
  left_s_ = std::max(0.0, left_s_ - steps_due * step_s);
  faults_.slipped_s += (steps_due - steps) * step_s;
  if (steps == 0) return;
  for (Seat& seat : seats_) seat.heard = false;
}

bool BodyWorld::has_shape_of(const BodyWorld& other) const noexcept {
  const mjModel& is = *model_;
  const mjModel& should = *other.model_;
  return is.nq == should.nq && is.nv == should.nv && is.na == should.na && is.nu == should.nu &&
         is.nbody == should.nbody && is.nmocap == should.nmocap && is.njnt == should.njnt && is.neq == should.neq &&
         std::equal(is.jnt_type, is.jnt_type + is.njnt, should.jnt_type) &&
         std::ranges::equal(seats_, other.seats_, {}, &Seat::body, &Seat::body);
}

bool BodyWorld::copy_from(const scene::DynamicModelState& other) noexcept {
  const auto* const from = dynamic_cast<const BodyWorld*>(&other);
  if (from == nullptr || !has_shape_of(*from)) return false;
  const mjModel& model = *model_;
  const mjData& source = *from->data_;
  mju_copy(data_->qpos, source.qpos, model.nq);
  mju_copy(data_->qvel, source.qvel, model.nv);
  mju_copy(data_->act, source.act, model.na);
  mju_copy(data_->qacc_warmstart, source.qacc_warmstart, model.nv);
  mju_copy(data_->ctrl, source.ctrl, model.nu);
  mju_copy(data_->qfrc_applied, source.qfrc_applied, model.nv);
  mju_copy(data_->xfrc_applied, source.xfrc_applied, 6 * model.nbody);
  mju_copy(data_->mocap_pos, source.mocap_pos, 3 * model.nmocap);
  mju_copy(data_->mocap_quat, source.mocap_quat, 4 * model.nmocap);
  std::copy_n(from->model_->eq_active, model.neq, model_->eq_active);
  std::copy_n(from->model_->eq_obj2id, model.neq, model_->eq_obj2id);
  mju_copy(model_->eq_data, from->model_->eq_data, mjNEQDATA * model.neq);
  data_->time = source.time;
  for (const int bad : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC}) data_->warning[bad].number = 0;
  std::ranges::copy(from->seats_, seats_.begin());
  left_s_ = from->left_s_;
  sound_ = from->sound_ && find_contacts(model, *data_);
  // That normalised the quaternions once more than in the other state.
  mju_copy(data_->qpos, source.qpos, model.nq);
  return true;
}

void BodyWorld::step_once(double before_end_s) noexcept {
  const int overfull = data_->warning[mjWARN_CONTACTFULL].number + data_->warning[mjWARN_CNSTRFULL].number;
  sound_ = begin_step(*model_, *data_);
  // MuJoCo's reset has cleared its counts.
  if (!sound_) return;
  faults_.contacts_left_out += static_cast<std::uint64_t>(data_->warning[mjWARN_CONTACTFULL].number +
                                                          data_->warning[mjWARN_CNSTRFULL].number - overfull);
  for (Seat& seat : seats_) {
    if (!seat.placed) continue;
    pull(seat, before_end_s);
    if (seat.weld >= 0) hold(seat);
  }
  sound_ = end_step(*model_, *data_);
}

void BodyWorld::pull(Seat& seat, double before_end_s) noexcept {
  // With a new position, the device was on its way during all the time that now passes. Without one it is held at the
  // last, with its velocity kept for `kVelocityHeld_s`: else each late motion would act like a blow of the damper.
  scene::Point end_m = seat.device_m;
  scene::Point end_m_per_s = scene::Point::Zero();
  if (seat.heard) end_m -= before_end_s * seat.device_m_per_s;
  if (seat.heard || seat.unmoved_s < kVelocityHeld_s) end_m_per_s = seat.device_m_per_s;
  seat.unmoved_s += model_->opt.timestep;
  seat.placed_s += model_->opt.timestep;
  if (const double left = 1 - seat.placed_s / seat.arrival_s; left > 0) {
    // Smooth in position and velocity at both ends.
    end_m += left * left * (3 - 2 * left) * seat.begins_aside_m;
    end_m_per_s -= 6 * left * (1 - left) / seat.arrival_s * seat.begins_aside_m;
  }
  seat.pushed_m = position_of(*data_, seat.body) - end_m;
  seat.force_N = coupling_.stiffness_N_per_m * local_model::no_longer_than(seat.pushed_m, kReachMost_m) +
                 coupling_.damping_N_s_per_m * (velocity_of(*model_, *data_, seat.body) - end_m_per_s);
  Eigen::Map<scene::Point>(data_->xfrc_applied + 6 * seat.body) = bearing_N(seat) - seat.force_N;
}

/// From the next step on.
void BodyWorld::hold(Seat& seat) noexcept {
  if (!seat.pressed) {
    let_go(seat);
    seat.slipped = false;
  } else if (seat.held < 0) {
    if (!seat.slipped) grasp(seat);
  } else {
    seat.overload_s = carried_N(seat) > grasp_->force_N_max ? seat.overload_s + model_->opt.timestep : 0;
    if (seat.overload_s <= kOverload_s_most) return;
    let_go(seat);
    seat.slipped = true;
  }
}

/// Of the body touched deepest, of those that move.
void BodyWorld::grasp(Seat& seat) noexcept {
  const mjContact* deepest = nullptr;
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    if (!touches(*model_, contact, seat.body)) continue;
    const int other = neighbour(*model_, contact, seat.body).body;
    if (model_->body_weldid[other] != 0 && (deepest == nullptr || contact.dist < deepest->dist)) deepest = &contact;
  }
  if (deepest == nullptr) return;
  seat.held = neighbour(*model_, *deepest, seat.body).body;
  // A weld's numbers: where the first body's origin is in the second, where it is in the first, and the turn from the
  // first to the second.
  mjtNum* const weld = model_->eq_data + mjNEQDATA * seat.weld;
  const scene::Point between_m = Eigen::Map<const scene::Point>(data_->xpos + 3 * seat.body) -
                                 Eigen::Map<const scene::Point>(data_->xpos + 3 * seat.held);
  mju_rotVecMatT(weld, between_m.data(), data_->xmat + 9 * seat.held);
  mju_zero(weld + 3, 3);
  mjtNum back[4];
  mju_negQuat(back, data_->xquat + 4 * seat.body);
  mju_mulQuat(weld + 6, back, data_->xquat + 4 * seat.held);
  model_->eq_obj2id[seat.weld] = seat.held;
  model_->eq_active[seat.weld] = 1;
  seat.overload_s = 0;
}

void BodyWorld::let_go(Seat& seat) noexcept {
  if (seat.held < 0) return;
  seat.held = -1;
  model_->eq_active[seat.weld] = 0;
}

/// By the weld in the last step; its first three rows are its force.
double BodyWorld::carried_N(const Seat& seat) const noexcept {
  for (int row = 0; row + 2 < data_->nefc; ++row) {
    if (data_->efc_type[row] != mjCNSTR_EQUALITY || data_->efc_id[row] != seat.weld) continue;
    return mju_norm3(data_->efc_force + row);
  }
  return 0;
}

scene::Point BodyWorld::bearing_N(const Probe& probe) const noexcept {
  // The ball's weight is compensated: the hand does not carry it.
  if (probe.slides < 0) return scene::Point::Zero();
  return -model_->body_mass[probe.body] * Eigen::Map<const scene::Point>(model_->opt.gravity);
}

scene::ModelTouch BodyWorld::touch(int at) noexcept {
  const Seat& seat = seats_[static_cast<std::size_t>(at)];
  scene::ModelTouch touch{.force_N = seat.force_N};
  const std::span contacts(data_->contact, static_cast<std::size_t>(data_->ncon));
  const bool in_contact = seat.held >= 0 || std::ranges::any_of(contacts, [&](const mjContact& contact) {
                            return touches(*model_, contact, seat.body);
                          });
  const double depth_m = seat.pushed_m.norm();
  if (!in_contact || !(depth_m > 0)) return touch;
  touch.normal = seat.pushed_m / depth_m;
  touch.penetration_m = depth_m;
  return touch;
}

bool BodyWorld::describe(int at, local_model::LocalModel& model) noexcept {
  const Seat& seat = seats_[static_cast<std::size_t>(at)];
  if (!sound_ || !seat.placed || seat.placed_s < seat.arrival_s) return false;
  const auto mass = describer_.describe(
      *model_, *data_,
      {.body = seat.body, .held = seat.held, .force_N = seat.force_N, .since_s = model_->opt.timestep + left_s_});
  if (!mass) return false;
  model.mass = *mass;
  model.has_mass = true;
  return true;
}

}  // namespace forcebound::server
