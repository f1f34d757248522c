#include "forcebound/server/robot/simulated_arm.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "forcebound/server/robot/inverse_kinematics.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

using RowMajor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kCoordinatesMax, kCoordinatesMax>;

/// What a brake slips at, beside the largest torque of its joint.
constexpr double kBrakeShare = 0.3;

/// As sensors of robots' wrists come: some hundred samples a second, a few tenths of a newton.
constexpr ForceSensorFacts kSensor{.period = std::chrono::milliseconds(2),
                                   .noise_N_sd = 0.15,
                                   .noise_N_m_sd = 0.005,
                                   .bias_N_max = 0.5,
                                   .bias_N_m_max = 0.02};

std::string in_words(const ToolPose& pose) {
  const auto row = [](const Eigen::Vector3d& v) {
    return "[" + text::rounded(v.x()) + ", " + text::rounded(v.y()) + ", " + text::rounded(v.z()) + "]";
  };
  const Eigen::AngleAxisd turn(pose.orientation);
  return row(pose.position) + " m, turned by " + row(turn.angle() * turn.axis()) + " rad";
}

/// @throws std::runtime_error
Vector start_of(const Task& task, const RobotModel& model) {
  const ToolPose& start = task.world->start;
  const Posture posture = posture_for(model, start);
  if (posture.reaches()) return posture.joints;
  throw std::runtime_error("task '" + task.name + "': the tool cannot start at " + in_words(start) + ": arm '" +
                           std::string(model.name()) + "' comes as near as " + text::fixed(1e3 * posture.off_m, 1) +
                           " mm and " + text::fixed(posture.off_rad, 3) + " rad");
}

}  // namespace

SimulatedArm::SimulatedArm(const Task& task, std::uint64_t seed)
    : model_(compile_mjcf(arm_mjcf(*task.world), "task '" + task.name + "'")),
      layout_(layout_of(*model_)),
      chain_(chain_of(*model_, layout_)),
      facts_(facts_of(*model_, layout_)),
      damping_(control::Damping::from_matrix(facts_.damping)),
      brakes_(kBrakeShare * chain_.limits().torque_max),
      data_(make_data(*model_)),
      surroundings_(*task.world),
      watch_(*task.world),
      commands_(facts_),
      sensor_(kSensor, seed) {
  if (model_->nv > kCoordinatesMax) throw std::runtime_error("task '" + task.name + "': too many bodies");
  const Vector start = start_of(task, chain_);
  std::ranges::copy(start, data_->qpos);
  opening_ = task.script.empty() ? 0 : std::clamp(task.script.front().grip, 0.0, 1.0);
  for (const ArmLayout::Finger& finger : layout_.fingers) data_->qpos[finger.position] = opening_ * finger.travel_m;
  const WorldObject* block = task.world->find(WorldObject::Shape::block);
  const WorldObject* table = task.world->find(WorldObject::Shape::surface);
  if (block != nullptr && table != nullptr) {
    data_->qpos[layout_.block_position + 2] -= Surroundings::sunk_m(*block, *table);
  }
  if (!find_dynamics(*model_, *data_)) throw std::runtime_error("task '" + task.name + "': MuJoCo cannot begin");
  find_tool_and_block();
}

std::string SimulatedArm::facts_in_words() const {
  const auto range = [](const Vector& rows) {
    return text::rounded(rows.minCoeff()) + " to " + text::rounded(rows.maxCoeff());
  };
  return facts_.name + ": simulated arm of " + std::to_string(facts_.joints()) + " joints, damping " +
         range(facts_.damping.diagonal()) + " N m s/rad, friction " + range(facts_.friction) + " N m, encoder step " +
         range(1e6 * facts_.encoder_step) + " urad, largest torque " + range(chain_.limits().torque_max) +
         " N m, latency " + text::rounded(1e3 * facts_.latency_s) + " ms, holds a torque for " +
         text::rounded(1e3 * facts_.hold_s_max) + " ms";
}

device::Reading SimulatedArm::read(Nanoseconds now) noexcept {
  advance_to(now);
  device::Reading reading;
  reading.latched = now;
  if (failed_) {
    reading.status = device::Reading::Status::failed;
    return reading;
  }
  const Eigen::Index joints = layout_.joints;
  reading.joint = Eigen::Map<const Eigen::VectorXd>(data_->qpos, joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    reading.joint[i] = facts_.encoder_step[i] * std::round(reading.joint[i] / facts_.encoder_step[i]);
  }
  reading.position = reading.joint;
  reading.jacobian = Matrix::Identity(joints, joints);
  reading.damping = &damping_;
  reading.handle.gripper = gripper();
  return reading;
}

void SimulatedArm::apply(Nanoseconds now, const Vector& torque) noexcept {
  advance_to(now);
  write_failed_ = stopped_ || failed_;
  if (write_failed_) {
    ++counters_.failed_writes;
    return;
  }
  const bool sound = torque.rows() == layout_.joints && torque.allFinite();
  counters_.faulty_commands += sound ? 0 : 1;
  Vector command = Vector::Zero(layout_.joints);
  if (sound) command = torque;
  const double excess = command.cwiseQuotient(chain_.limits().torque_max).cwiseAbs().maxCoeff();
  if (excess > 1) command /= excess;
  commands_.command(time_, command);
}

std::optional<Nanoseconds> SimulatedArm::released_at() const noexcept {
  if (!origin_ || !commands_.released()) return std::nullopt;
  return *origin_ + *commands_.released();
}

std::optional<control::PassivityAudit> SimulatedArm::audit() const noexcept {
  return control::PassivityAudit{.energy_J = energy_.value_J(), .minimum_J = least_J_};
}

std::optional<SensedForce> SimulatedArm::sensed_force() const noexcept {
  std::optional<SensedForce> sensed = sensor_.newest();
  if (sensed && origin_) sensed->sampled += *origin_;
  return sensed;
}

void SimulatedArm::command_gripper(Nanoseconds now, double opening) noexcept {
  advance_to(now);
  if (std::isfinite(opening)) opening_ = std::clamp(opening, 0.0, 1.0);
}

std::optional<double> SimulatedArm::gripper() const noexcept {
  double opening = 0;
  for (const ArmLayout::Finger& finger : layout_.fingers) opening += data_->qpos[finger.position] / finger.travel_m;
  return std::clamp(opening / static_cast<double>(layout_.fingers.size()), 0.0, 1.0);
}

void SimulatedArm::soft_stop(Nanoseconds now) noexcept {
  advance_to(now);
  if (stopped_) return;
  stopped_ = true;
  // The command may have been on its way or in effect, and has ended in either case.
  commands_.drop(time_);
  write_failed_ = true;
}

std::optional<ToolPose> SimulatedArm::block() const noexcept {
  if (!layout_.block_body) return std::nullopt;
  return ToolPose{.position = block_.position, .orientation = Eigen::Quaterniond(block_.axes)};
}

void SimulatedArm::resume(Nanoseconds now) noexcept {
  advance_to(now);
  stopped_ = false;
}

void SimulatedArm::push(Nanoseconds now, const Vector6& wrench) noexcept {
  advance_to(now);
  if (wrench.allFinite()) push_ = wrench;
}

SimulatedArm::Truth SimulatedArm::truth() const noexcept {
  Truth truth{.joint = Eigen::Map<const Eigen::VectorXd>(data_->qpos, layout_.joints),
              .joint_velocity = Eigen::Map<const Eigen::VectorXd>(data_->qvel, layout_.joints),
              .tool = tool_,
              .block = block_};
  truth.kinetic_J = 0.5 * truth.joint_velocity.dot(chain_.mass_matrix(truth.joint) * truth.joint_velocity);
  return truth;
}

void SimulatedArm::advance_to(Nanoseconds now) noexcept {
  if (!origin_) origin_ = now;
  const Nanoseconds excess = now - *origin_ - time_ - kGapMax;
  if (excess > Nanoseconds{0}) {
    *origin_ += excess;
    ++counters_.gaps_cut;
  }
  const Nanoseconds end = now - *origin_;
  while (time_ < end && !failed_) {
    const Nanoseconds next = commands_.next_change(time_, end);
    for (Nanoseconds::rep parts = (next - time_ + kStepMost - Nanoseconds{1}) / kStepMost; parts > 0; --parts) {
      const Nanoseconds length = (next - time_) / parts;
      step(time::to_seconds(length));
      time_ += length;
      sensor_.pass(time_, -contact_.tool - push_);
      watch_.pass({.time_s = time::to_seconds(time_),
                   .step_s = time::to_seconds(length),
                   .tool = tool_,
                   .block = block_,
                   .wrench = -contact_.tool,
                   .touches = contact_.tool_touches});
    }
    commands_.pass(time_);
  }
}

/// What is at the positions and velocities of the last find_dynamics, which is the step's beginning, is left for the
/// tool's and block's state too.
void SimulatedArm::step(double step_s) noexcept {
  if (failed_) return;
  if (!find_dynamics(*model_, *data_)) return fail("MuJoCo cannot find the arm's motion");
  find_tool_and_block();
  const Eigen::Index rows = model_->nv;
  RowMajor mass(rows, rows);
  mj_fullM(model_.get(), mass.data(), data_->qM);
  CoordinateMatrix a = mass;
  Eigen::Map<Coordinates> speed(data_->qvel, rows);
  Coordinates force = -Eigen::Map<const Eigen::VectorXd>(data_->qfrc_bias, rows);
  Coordinates friction = Coordinates::Zero(rows);
  const Eigen::Index joints = layout_.joints;
  force.head(joints) += commands_.torque();
  friction.head(joints) = step_s * facts_.friction;
  if (stopped_) friction.head(joints) += step_s * brakes_;
  add_end_stops(force);
  add_contacts(step_s, force);
  const Coordinates momentum = a * speed;
  a.topLeftCorner(joints, joints) += step_s * facts_.damping;
  add_servos(step_s, a, force);
  Coordinates next(rows);
  const Coordinates r = momentum + step_s * force;
  if (!friction_.solve(a, r, friction, next)) {
    // Everything stands still for this step, which gives nobody any energy.
    ++counters_.frozen_joints;
    next.setZero();
  }
  if (!next.allFinite()) return fail("the arm's motion is not finite");
  speed = next;
  balance(step_s);
  mj_integratePos(model_.get(), data_->qpos, data_->qvel, step_s);
}

void SimulatedArm::find_tool_and_block() noexcept {
  const Eigen::Index rows = model_->nv;
  RowMajor linear(3, rows);
  RowMajor turning(3, rows);
  const double* const tool = data_->site_xpos + static_cast<std::ptrdiff_t>(3) * layout_.tool_site;
  mj_jac(model_.get(), data_.get(), linear.data(), turning.data(), tool, layout_.tool_body);
  jacobian_.resize(6, layout_.joints);
  jacobian_ << linear.leftCols(layout_.joints), turning.leftCols(layout_.joints);
  using Axes = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Map<const Coordinates> speed(data_->qvel, rows);
  const Vector6 velocity = jacobian_ * speed.head(layout_.joints);
  tool_ = {.position = Eigen::Map<const Eigen::Vector3d>(tool),
           .axes = Eigen::Map<const Axes>(data_->site_xmat + static_cast<std::ptrdiff_t>(9) * layout_.tool_site),
           .velocity = velocity.head<3>(),
           .turn = velocity.tail<3>()};
  if (!layout_.block_body) return;
  block_.position = Eigen::Map<const Eigen::Vector3d>(data_->qpos + layout_.block_position);
  block_.axes = Eigen::Map<const Axes>(data_->xmat + static_cast<std::ptrdiff_t>(9) * *layout_.block_body);
  block_.velocity = speed.segment<3>(layout_.block_speed);
  // MuJoCo has a free body's turning in its own frame.
  block_.turn = block_.axes * speed.segment<3>(layout_.block_speed + 3);
}

void SimulatedArm::add_contacts(double step_s, Coordinates& force) noexcept {
  contact_ = surroundings_.touch(tool_, block_, step_s);
  force.head(layout_.joints) += jacobian_.transpose() * (contact_.tool + push_);
  if (!layout_.block_body) return;
  force.segment<3>(layout_.block_speed) += contact_.block.head<3>();
  force[layout_.block_speed + 2] -= kGravity_m_per_s2 * model_->body_mass[*layout_.block_body];
  force.segment<3>(layout_.block_speed + 3) += block_.axes.transpose() * contact_.block.tail<3>();
}

void SimulatedArm::add_servos(double step_s, CoordinateMatrix& a, Coordinates& force) const noexcept {
  for (const ArmLayout::Finger& finger : layout_.fingers) {
    const double off_m = opening_ * finger.travel_m - data_->qpos[finger.position];
    force[finger.speed] += std::clamp(finger.stiffness_N_per_m * off_m, -finger.force_N_max, finger.force_N_max);
    a(finger.speed, finger.speed) += step_s * finger.damping_N_s_per_m;
  }
}

void SimulatedArm::add_end_stops(Coordinates& force) const noexcept {
  constexpr double kStiffness_N_m_per_rad = 2000;
  constexpr double kDamping_N_m_s_per_rad = 10;
  const RobotLimits& limits = chain_.limits();
  for (Eigen::Index i = 0; i < layout_.joints; ++i) {
    const double q = data_->qpos[i];
    const double beyond = q - std::clamp(q, limits.lowest[i], limits.highest[i]);
    if (beyond == 0) continue;
    const double torque = -kStiffness_N_m_per_rad * beyond - kDamping_N_m_s_per_rad * data_->qvel[i];
    force[i] += beyond > 0 ? std::min(torque, 0.0) : std::max(torque, 0.0);
  }
}

/// Of the step that ends with the present velocities, before or after the positions moved.
void SimulatedArm::balance(double step_s) noexcept {
  double taken_J = 0;
  for (Eigen::Index i = 0; i < layout_.joints; ++i) {
    const double moved = step_s * data_->qvel[i];
    // What brakes take beyond that counts for nobody.
    taken_J += facts_.damping(i, i) * moved * data_->qvel[i] + facts_.friction[i] * std::abs(moved) -
               commands_.torque()[i] * moved;
  }
  energy_.add(taken_J);
  least_J_ = std::min(least_J_, energy_.value_J());
}

void SimulatedArm::fail(std::string_view why) noexcept {
  failed_ = true;
  error_ = why;
  commands_.drop(time_);
}

}  // namespace forcebound::server
