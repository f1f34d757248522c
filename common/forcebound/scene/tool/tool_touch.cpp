#include "forcebound/scene/tool/tool_touch.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace forcebound::scene {

ToolTouch::ToolTouch(std::shared_ptr<const Tool> tool, const Scene& scene)
    : tool_(std::move(tool)), visited_(scene.plan().steps().size()), foremost_(visited_.size()) {
  const std::size_t points = tool_->points().size();
  for (Visited& visited : visited_) {
    visited.points.reserve(points);
    visited.touching.reserve(points);
  }
  tree_.reserve(points);
  near_.reserve(points);
  if (tool_->contact() == ToolContact::constraint) proxy_.emplace(tool_, scene);
}

void ToolTouch::move(const ToolPose& pose) noexcept {
  // How it was turned where it was free is not known: as it is now.
  before_ = placed_ || !free_m_ ? pose_ : ToolPose{.tip_m = *free_m_, .rotation = pose.rotation};
  pose_ = pose;
  moved_ = std::exchange(placed_, true) || free_m_;
}

void ToolTouch::begin_again(const Point& free_m) noexcept {
  for (Visited& visited : visited_) {
    visited.points.clear();
    visited.touching.clear();
  }
  std::ranges::fill(foremost_, Foremost{});
  if (proxy_) proxy_->begin_again();
  free_m_ = free_m;
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
  foremost_ = other.foremost_;
  if (proxy_) proxy_->go_on_from(*other.proxy_);
  pose_ = other.pose_;
  before_ = other.before_;
  free_m_ = other.free_m_;
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
  if (proxy_ && step.solid) return feel_solid(plan, number, at_tip, states);
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
    Touching touching{.in_handle_m = point.at_m,
                      .surface = run.find_surface(step, pose_ * point.at_m),
                      .arm_m = pose_.rotation * point.at_m,
                      .seen_m = pose_ * point.at_m};
    touching.surface.penetration_m += point.radius_m;
    add(step, touching, run, at_tip, felt);
    if (touching.surface.penetration_m > 0) visited.touching.push_back(number_of_point);
  }
  std::swap(visited.points, near_);
  return felt;
}

ToolFelt ToolTouch::feel_solid(const Plan& plan, std::size_t number, const Probe& at_tip,
                               std::span<std::byte> states) noexcept {
  Point missing_m = Point::Zero();
  for (const ToolProxy::Near& one : proxy_->near(number)) missing_m += one.share_m * one.surface.normal;
  for (const ToolProxy::NearEdge& one : proxy_->near_edges(number)) missing_m += one.share_m * one.surface.normal;
  Feeling now{.plan = plan,
              .step = plan.steps()[number],
              .at_tip = at_tip,
              .states = states,
              .before = foremost_[number],
              .together_m = missing_m.norm()};
  const auto acts = [&](const ToolProxy::Contact& one) {
    return one.acted || one.share_m > 0 || -one.surface.penetration_m < now.step.reach_m;
  };
  for (ToolProxy::Near& one : proxy_->near(number)) {
    if (acts(one)) feel_contact(now, one, tool_->points()[one.point].at_m, one.point);
  }
  for (ToolProxy::NearEdge& one : proxy_->near_edges(number)) {
    if (!acts(one)) continue;
    proxy_->keep_state(one, plan, number, states);
    feel_contact(now, one, one.in_handle_m, proxy_->state_of(one));
  }
  if (now.foremost.share_m > 0) copy_touching(now, now.foremost_state, state_of_foremost());
  foremost_[number] = now.foremost;
  // The device is as far in as its contacts share, unless they push against each other.
  if (now.together_m > now.felt.deepest.penetration_m) {
    now.felt.deepest.normal = missing_m / now.together_m;
    now.felt.deepest.penetration_m = now.together_m;
  }
  return now.felt;
}

void ToolTouch::feel_contact(Feeling& now, ToolProxy::Contact& one, const Point& in_handle_m,
                             std::size_t state) const noexcept {
  slide(now, one, in_handle_m, state);
  Touching touching{.in_handle_m = in_handle_m,
                    .surface = one.surface,
                    .arm_m = proxy_->centre_m() - pose_.tip_m + one.arm_m,
                    .seen_m = one.slid_m};
  touching.surface.penetration_m = one.share_m > 0 ? one.share_m : std::min(0.0, one.surface.penetration_m);
  // Sides that face each other push apart what is between them, each as if it were alone.
  if (one.share_m < now.together_m) touching.share = one.share_m / now.together_m;
  add(now.step, touching, {now.plan, now.states.data() + state * now.plan.state_bytes()}, now.at_tip, now.felt);
  one.felt_share_m = one.share_m;
  one.acted = one.share_m > 0 || -one.surface.penetration_m < now.step.reach_m;
  if (!(one.share_m > now.foremost.share_m)) return;
  now.foremost = {.share_m = one.share_m, .slid_m = one.slid_m, .normal = one.surface.normal};
  now.foremost_state = state;
}

void ToolTouch::slide(const Feeling& now, ToolProxy::Contact& one, const Point& in_handle_m,
                      std::size_t state) const noexcept {
  constexpr double kSameWay = 0.9;
  const Point here_m = pose_ * in_handle_m;
  const Point way_m = moved_ ? Point(here_m - before_ * in_handle_m) : Point::Zero();
  one.slid_m = one.acted ? Point(one.slid_m + way_m) : here_m;
  const bool takes_over = one.felt_share_m < 0.5 * one.share_m && now.before.share_m > 0;
  if (!takes_over || !(now.before.normal.dot(one.surface.normal) > kSameWay)) return;
  one.slid_m = now.before.slid_m + way_m;
  copy_touching(now, state_of_foremost(), state);
}

/// The states of effects that act within the solid.
void ToolTouch::copy_touching(const Feeling& now, std::size_t from, std::size_t to) const noexcept {
  const std::byte* const bytes = now.states.data() + from * now.plan.state_bytes();
  std::copy(bytes + now.step.touching_state, bytes + now.step.end_state,
            now.states.data() + to * now.plan.state_bytes() + now.step.touching_state);
}

void ToolTouch::add(const PlanStep& step, const Touching& touching, const PlanRun& run, Probe probe,
                    ToolFelt& felt) const noexcept {
  const Point& at_m = touching.in_handle_m;
  const Point here_m = pose_ * at_m;
  probe.position_m = touching.seen_m;
  probe.normal = touching.surface.normal;
  probe.penetration_m = touching.surface.penetration_m;
  probe.velocity_m_per_s = Point::Zero();
  if (moved_ && probe.interval_s > 0) {
    Point velocity_m_per_s = (here_m - before_ * at_m) / probe.interval_s;
    velocity_m_per_s -= (1 - touching.share) * velocity_m_per_s.dot(probe.normal) * probe.normal;
    // The difference of two finite positions may overflow.
    if (velocity_m_per_s.allFinite()) probe.velocity_m_per_s = velocity_m_per_s;
  }
  Reaction reaction;
  run.act(step, probe, reaction);
  felt.reaction.force_N += reaction.force_N;
  felt.reaction.fading_N += reaction.fading_N;
  const Point along_N = reaction.force_N.dot(probe.normal) * probe.normal;
  felt.torque_N_m += touching.arm_m.cross(along_N) + (here_m - pose_.tip_m).cross(reaction.force_N - along_N);
  if (!(touching.surface.penetration_m > 0)) return;
  ++felt.contacts;
  if (touching.surface.penetration_m > felt.deepest.penetration_m) felt.deepest = touching.surface;
}

}  // namespace forcebound::scene
