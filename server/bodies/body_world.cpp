#include "forcebound/server/bodies/body_world.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

namespace forcebound::server {
namespace {

constexpr int kStepsMax = 50;
// A device that is farther from its probe, or faster, pulls no harder: beyond any hand, and short of what makes bodies
// fly off.
constexpr double kReach_m = 0.2;
constexpr double kSpeed_m_per_s_max = 5;
constexpr double kVelocityHeld_s = 0.01;
// A device that is farther away than that is a stranger's nonsense, which must not break what others feel.
constexpr double kFar_m = 100;

Point at_most(const Point& vector, double length) noexcept {
  const double whole = vector.stableNorm();
  return whole > length ? Point(vector * (length / whole)) : vector;
}

Point velocity_of(const mjModel& model, const mjData& data, int body) noexcept {
  mjtNum velocity[6];
  mj_objectVelocity(&model, &data, mjOBJ_XBODY, body, velocity, 0);
  return {velocity[3], velocity[4], velocity[5]};
}

Point position_of(const mjData& data, int body) noexcept { return Eigen::Map<const Point>(data.xpos + 3 * body); }

}  // namespace

BodyWorld::BodyWorld(ModelPointer model, const Coupling& coupling, std::vector<Probe> probes)
    : model_(std::move(model)), data_(make_data(*model_)), coupling_(coupling), probes_(std::move(probes)) {
  for (std::size_t i = 0; i < probes_.size(); ++i) park(i);
  mj_forward(model_.get(), data_.get());
}

int BodyWorld::join() {
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    if (probes_[i].taken) continue;
    probes_[i].taken = true;
    probes_[i].placed = false;
    return static_cast<int>(i);
  }
  return -1;
}

void BodyWorld::leave(int seat) {
  const auto i = static_cast<std::size_t>(seat);
  probes_[i].taken = false;
  park(i);
}

void BodyWorld::park(std::size_t probe) noexcept {
  Probe& parked = probes_[probe];
  parked.placed = false;
  parked.force_N.setZero();
  mju_zero(data_->xfrc_applied + 6 * parked.body, 6);
  if (parked.slides >= 0) place(parked, parking_m(static_cast<int>(probe)));
}

void BodyWorld::place(Probe& probe, const Point& position_m) noexcept {
  // Slides begin at the origin, where their body is.
  for (int axis = 0; axis < 3; ++axis) data_->qpos[probe.slides + axis] = position_m[axis];
  const int velocities = model_->jnt_dofadr[model_->body_jntadr[probe.body]];
  mju_zero(data_->qvel + velocities, 3);
}

void BodyWorld::move(int seat, const Point& position_m, const Point& velocity_m_per_s) noexcept {
  Probe& probe = probes_[static_cast<std::size_t>(seat)];
  if (!probe.placed) {
    probe.placed = true;
    // A probe of ours begins where its device is; a body of the author's is drawn to it.
    if (probe.slides >= 0) {
      place(probe, at_most(position_m, kFar_m));
      mj_kinematics(model_.get(), data_.get());
    }
  }
  probe.device_m = at_most(position_m, kFar_m);
  probe.device_m_per_s = at_most(velocity_m_per_s, kSpeed_m_per_s_max);
  probe.silent_s = 0;
}

void BodyWorld::advance(double elapsed_s) noexcept {
  if (!sound_) return;
  left_s_ += elapsed_s;
  const double step_s = model_->opt.timestep;
  // A rounding's worth less than a step is a step.
  const double steps_due = std::floor(left_s_ / step_s + 1e-6);
  const int steps = static_cast<int>(std::min<double>(steps_due, kStepsMax));
  for (int i = 1; i <= steps && sound_; ++i) step_once((steps - i) * step_s);
  left_s_ = std::max(0.0, left_s_ - steps_due * step_s);
  faults_.slipped_s += (steps_due - steps) * step_s;
  for (Probe& probe : probes_) probe.silent_s += steps * step_s;
}

void BodyWorld::step_once(double before_end_s) noexcept {
  for (Probe& probe : probes_) {
    if (!probe.placed) {
      if (probe.slides >= 0) pull(probe, position_of(*data_, probe.body), Point::Zero());
      continue;
    }
    // Once heard of, the device was on its way all the time that now passes. Unheard of it is where it was, and its
    // velocity is believed for a moment: without it every late motion would be a blow of the damper.
    const double on_way_s = probe.silent_s > 0 ? 0 : before_end_s;
    const bool moves = probe.silent_s < kVelocityHeld_s;
    pull(probe, probe.device_m - on_way_s * probe.device_m_per_s, moves ? probe.device_m_per_s : Point(Point::Zero()));
  }
  const int overfull = data_->warning[mjWARN_CONTACTFULL].number + data_->warning[mjWARN_CNSTRFULL].number;
  sound_ = step(*model_, *data_);
  faults_.contacts_left_out += static_cast<std::uint64_t>(data_->warning[mjWARN_CONTACTFULL].number +
                                                          data_->warning[mjWARN_CNSTRFULL].number - overfull);
}

void BodyWorld::pull(Probe& probe, const Point& device_m, const Point& device_m_per_s) noexcept {
  const Point place_m = position_of(*data_, probe.body);
  const Point passing_m_per_s = device_m_per_s - velocity_of(*model_, *data_, probe.body);
  const Point pull_N = coupling_.stiffness_N_per_m * at_most(device_m - place_m, kReach_m) +
                       coupling_.damping_N_s_per_m * passing_m_per_s;
  probe.force_N = -pull_N;
  Eigen::Map<Point> applied(data_->xfrc_applied + 6 * probe.body);
  applied = pull_N;
  // Its weight is the device's matter, not the hand's.
  if (probe.slides >= 0) applied -= model_->body_mass[probe.body] * Eigen::Map<const Point>(model_->opt.gravity);
}

MediumTouch BodyWorld::touch(int seat) noexcept {
  const Probe& probe = probes_[static_cast<std::size_t>(seat)];
  MediumTouch touch{.force_N = probe.force_N};
  bool in_contact = false;
  for (int i = 0; i < data_->ncon && !in_contact; ++i) {
    const mjContact& contact = data_->contact[i];
    in_contact = model_->geom_bodyid[contact.geom1] == probe.body || model_->geom_bodyid[contact.geom2] == probe.body;
  }
  const Point pushed_m = position_of(*data_, probe.body) - probe.device_m;
  const double depth_m = pushed_m.norm();
  if (!in_contact || !(depth_m > 0)) return touch;
  touch.normal = pushed_m / depth_m;
  touch.penetration_m = depth_m;
  return touch;
}

}  // namespace forcebound::server
