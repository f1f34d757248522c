#include "forcebound/server/robot/task_watch.hpp"

#include <algorithm>
#include <limits>

namespace forcebound::server {

TaskWatch::TaskWatch(const Task::World& world) : goal_(world.goal), apart_s_(std::numeric_limits<double>::infinity()) {
  progress_.goal = goal_.least;
  progress_.tool = world.start;
  if (const WorldObject* block = world.find(WorldObject::Shape::block)) block_start_ = block->position;
  if (const WorldObject* hole = world.find(WorldObject::Shape::hole)) {
    hole_ = hole->position;
    hole_radius_m_ = hole->radius_m;
  }
}

void TaskWatch::pass(const Truth& truth) noexcept {
  progress_.force_N = truth.wrench.head<3>();
  progress_.torque_N_m = truth.wrench.tail<3>();
  progress_.tool = {.position = truth.tool.position, .orientation = Eigen::Quaterniond(truth.tool.axes)};
  progress_.tool_velocity << truth.tool.velocity, truth.tool.turn;
  progress_.in_contact = truth.touches;
  progress_.peak_N = std::max(progress_.peak_N, progress_.force_N.norm());
  progress_.measure = measured(truth);
  if (progress_.succeeded || progress_.measure < goal_.least) return;
  progress_.succeeded = true;
  progress_.succeeded_s = truth.time_s;
}

double TaskWatch::measured(const Truth& truth) noexcept {
  switch (goal_.kind) {
    case TaskGoal::Kind::hold_force:
      return held_s(truth);
    case TaskGoal::Kind::slide:
      return slid_m(truth);
    case TaskGoal::Kind::insert:
      return inserted_m(truth);
    case TaskGoal::Kind::push:
      break;
  }
  return goal_.direction.dot(truth.block.position - block_start_);
}

/// The longest so far.
double TaskWatch::held_s(const Truth& truth) noexcept {
  const double force_N = progress_.force_N.norm();
  const bool within = force_N >= goal_.force_N_least && force_N <= goal_.force_N_most;
  held_s_ = within ? held_s_ + truth.step_s : 0;
  return std::max(progress_.measure, held_s_);
}

/// The longest way so far.
double TaskWatch::slid_m(const Truth& truth) noexcept {
  constexpr double kApartMost_s = 0.1;
  apart_s_ = truth.touches ? 0 : apart_s_ + truth.step_s;
  if (apart_s_ > kApartMost_s) sliding_ = false;
  if (!truth.touches) return progress_.measure;
  const double here = goal_.direction.dot(truth.tool.position);
  slid_least_ = sliding_ ? std::min(slid_least_, here) : here;
  slid_most_ = sliding_ ? std::max(slid_most_, here) : here;
  sliding_ = true;
  return std::max(progress_.measure, slid_most_ - slid_least_);
}

double TaskWatch::inserted_m(const Truth& truth) const noexcept {
  const Eigen::Vector3d from_hole = truth.tool.position - hole_;
  return from_hole.head<2>().norm() < hole_radius_m_ ? std::max(0.0, -from_hole.z()) : 0.0;
}

}  // namespace forcebound::server
