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
  if (tool_->contact() == ToolContact::constraint) proxy_.emplace(tool_, plan);
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
  if (proxy_) proxy_->begin_again();
  placed_ = false;
}

bool ToolTouch::go_on_from(const ToolTouch& other) noexcept {
  if (other.tool_->points().size() != tool_->points().size() || other.visited_.size() != visited_.size()) return false;
  if (other.proxy_.has_value() != proxy_.has_value()) return false;
  // No larger than what was reserved, so nothing is allocated.
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    visited_[i].points = other.visited_[i].points;
    visited_[i].touching = other.visited_[i].touching;
  }
  if (proxy_) proxy_->go_on_from(*other.proxy_);
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
  if (proxy_ && step.solid) return feel_solid(step, number, plan, at_tip, states);
  Visited& visited = visited_[number];
  find_near(step, visited);
  const auto run_of = [&](std::uint32_t point) { return PlanRun(plan, states.data() + point * plan.state_bytes()); };
  for (const std::uint32_t point : visited.points) {
    if (!std::ranges::binary_search(near_, point)) run_of(point).forget(step);
  }
  visited.touching.clear();
  ToolFelt felt;
  for (const std::uint32_t number_of_point : near_) {
    const ToolPoint& point = tool_->points()[number_of_point];
    const PlanRun run = run_of(number_of_point);
    if (moved_ && !std::ranges::binary_search(visited.points, number_of_point))
      run.begin_outside(step, before_ * point.at_m);
    Touching touching{.number = number_of_point,
                      .surface = run.find_surface(step, pose_ * point.at_m),
                      .arm_m = pose_.rotation * point.at_m};
    touching.surface.penetration_m += point.radius_m;
    add(step, touching, run, at_tip, felt);
    if (touching.surface.penetration_m > 0) visited.touching.push_back(number_of_point);
  }
  std::swap(visited.points, near_);
  return felt;
}

ToolFelt ToolTouch::feel_solid(const PlanStep& step, std::size_t number, const Plan& plan, const Probe& at_tip,
                               std::span<std::byte> states) const noexcept {
  const std::span<const ToolProxy::Near> near = proxy_->near(number);
  Point missing_m = Point::Zero();
  for (const ToolProxy::Near& one : near) missing_m += one.share_m * one.surface.normal;
  const double together_m = missing_m.norm();
  const Point from_tip_m = proxy_->centre_m() - pose_.tip_m;
  ToolFelt felt;
  for (const ToolProxy::Near& one : near) {
    Touching touching{.number = one.point, .surface = one.surface, .arm_m = from_tip_m + one.arm_m};
    touching.surface.penetration_m = one.share_m > 0 ? one.share_m : std::min(0.0, one.surface.penetration_m);
    // Sides that face each other push apart what is between them, each as if it were alone.
    if (one.share_m < together_m) touching.share = one.share_m / together_m;
    add(step, touching, {plan, states.data() + one.point * plan.state_bytes()}, at_tip, felt);
  }
  return felt;
}

void ToolTouch::add(const PlanStep& step, const Touching& touching, const PlanRun& run, Probe probe,
                    ToolFelt& felt) const noexcept {
  const Point& at_m = tool_->points()[touching.number].at_m;
  probe.position_m = pose_ * at_m;
  probe.normal = touching.surface.normal;
  probe.penetration_m = touching.surface.penetration_m;
  probe.velocity_m_per_s = Point::Zero();
  if (moved_ && probe.interval_s > 0) {
    Point velocity_m_per_s = (probe.position_m - before_ * at_m) / probe.interval_s;
    velocity_m_per_s -= (1 - touching.share) * velocity_m_per_s.dot(probe.normal) * probe.normal;
    // The difference of two finite positions may overflow.
    if (velocity_m_per_s.allFinite()) probe.velocity_m_per_s = velocity_m_per_s;
  }
  Reaction reaction;
  run.act(step, probe, reaction);
  felt.reaction.force_N += reaction.force_N;
  felt.reaction.fading_N += reaction.fading_N;
  const Point along_N = reaction.force_N.dot(probe.normal) * probe.normal;
  felt.torque_N_m += touching.arm_m.cross(along_N) + (probe.position_m - pose_.tip_m).cross(reaction.force_N - along_N);
  if (!(touching.surface.penetration_m > 0)) return;
  ++felt.contacts;
  if (touching.surface.penetration_m > felt.deepest.penetration_m) felt.deepest = touching.surface;
}

}  // namespace forcebound::scene
