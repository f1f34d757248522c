#include "forcebound/scene/tool/tool_touch.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace forcebound::scene {

ToolTouch::ToolTouch(std::shared_ptr<const Tool> tool, const Plan& plan)
    : tool_(std::move(tool)), visited_(plan.steps().size()) {
  const std::size_t points = tool_->points().size();
  for (Visited& visited : visited_) {
    visited.points.reserve(points);
    visited.touching.reserve(points);
  }
  tree_.reserve(points);
  near_.reserve(points);
}

void ToolTouch::move(const ToolPose& pose) noexcept {
  before_ = pose_;
  pose_ = pose;
  moved_ = std::exchange(placed_, true);
}

void ToolTouch::begin_again() noexcept {
  for (Visited& visited : visited_) {
    visited.points.clear();
    visited.touching.clear();
  }
  placed_ = false;
}

bool ToolTouch::go_on_from(const ToolTouch& other) noexcept {
  if (other.tool_->points().size() != tool_->points().size() || other.visited_.size() != visited_.size()) return false;
  // No larger than what was reserved, so nothing is allocated.
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    visited_[i].points = other.visited_[i].points;
    visited_[i].touching = other.visited_[i].touching;
  }
  pose_ = other.pose_;
  before_ = other.before_;
  placed_ = other.placed_;
  moved_ = other.moved_;
  return true;
}

void ToolTouch::find_near(const PlanStep& step, const Visited& before) noexcept {
  double margin_m = step.reach_m;
  // |(R - R_before) p| <= |R - R_before| |p|
  if (moved_) {
    margin_m += (pose_.tip_m - before_.tip_m).norm() + (pose_.rotation - before_.rotation).norm() * tool_->reach_m();
  }
  tree_.clear();
  near_.clear();
  tool_->find_near(*step.shape, pose_, margin_m, tree_);
  std::ranges::set_union(tree_, before.touching, std::back_inserter(near_));
}

ToolFelt ToolTouch::feel(const Plan& plan, std::size_t number, const Probe& at_tip,
                         std::span<std::byte> states) noexcept {
  const PlanStep& step = plan.steps()[number];
  Visited& visited = visited_[number];
  find_near(step, visited);
  const auto run_of = [&](std::uint32_t point) { return PlanRun(plan, states.data() + point * plan.state_bytes()); };
  for (const std::uint32_t point : visited.points) {
    if (!std::ranges::binary_search(near_, point)) run_of(point).forget(step);
  }
  visited.touching.clear();
  ToolFelt felt;
  for (const std::uint32_t point : near_) {
    const PlanRun run = run_of(point);
    if (moved_ && !std::ranges::binary_search(visited.points, point))
      run.begin_outside(step, before_ * tool_->points()[point].at_m);
    const std::size_t contacts = felt.contacts;
    add(step, point, run, at_tip, felt);
    if (felt.contacts > contacts) visited.touching.push_back(point);
  }
  std::swap(visited.points, near_);
  return felt;
}

void ToolTouch::add(const PlanStep& step, std::uint32_t number, const PlanRun& run, Probe probe,
                    ToolFelt& felt) const noexcept {
  const ToolPoint& point = tool_->points()[number];
  const Point arm_m = pose_.rotation * point.at_m;
  probe.position_m = pose_.tip_m + arm_m;
  probe.velocity_m_per_s = Point::Zero();
  if (moved_ && probe.interval_s > 0) {
    const Point velocity_m_per_s = (probe.position_m - before_ * point.at_m) / probe.interval_s;
    // The difference of two finite positions may overflow.
    if (velocity_m_per_s.allFinite()) probe.velocity_m_per_s = velocity_m_per_s;
  }
  SurfacePoint surface = run.find_surface(step, probe.position_m);
  surface.penetration_m += point.radius_m;
  probe.normal = surface.normal;
  probe.penetration_m = surface.penetration_m;
  Reaction reaction;
  run.act(step, probe, reaction);
  felt.reaction.force_N += reaction.force_N;
  felt.reaction.fading_N += reaction.fading_N;
  felt.torque_N_m += arm_m.cross(reaction.force_N);
  if (!(surface.penetration_m > 0)) return;
  ++felt.contacts;
  if (surface.penetration_m > felt.deepest.penetration_m) felt.deepest = surface;
}

}  // namespace forcebound::scene
