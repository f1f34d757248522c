#include "forcebound/scene/tool/tool_proxy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "forcebound/control/rotation.hpp"

namespace forcebound::scene {
namespace {

// Less than a point moves by rounding, and than anybody feels.
constexpr double kStill_m = 1e-8;
constexpr double kConverged_m = 1e-10;
// In free space a tool goes as far at once, if nothing is nearer.
constexpr double kFreeMost_m = 0.01;

}  // namespace

ToolProxy::ToolProxy(std::shared_ptr<const Tool> tool, const Plan& plan)
    : tool_(std::move(tool)), near_(plan.steps().size()) {
  const std::size_t points = tool_->points().size();
  std::size_t solid = 0;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (!plan.steps()[i].solid) continue;
    near_[i].reserve(points);
    ++solid;
  }
  next_.reserve(points);
  tree_.reserve(points);
  rows_.reserve(points * solid);
  working_.reserve(points * solid);
}

void ToolProxy::begin_again() noexcept {
  for (std::vector<Near>& near : near_) near.clear();
  placed_ = false;
}

void ToolProxy::go_on_from(const ToolProxy& other) noexcept {
  // No larger than what was reserved, so nothing is allocated.
  for (std::size_t i = 0; i < near_.size(); ++i) near_[i].assign(other.near_[i].begin(), other.near_[i].end());
  pose_ = other.pose_;
  placed_ = other.placed_;
}

ToolProxy::Twist ToolProxy::twist_to(const ToolPose& device) const noexcept {
  Twist twist;
  twist.head<3>() = device * tool_->centre_m() - centre_m();
  twist.tail<3>() = tool_->spread_m() *
                    control::rotation_vector(Eigen::Quaterniond(pose_.rotation), Eigen::Quaterniond(device.rotation));
  return twist;
}

double ToolProxy::length_m(const Twist& twist) const noexcept {
  return twist.head<3>().norm() + twist.tail<3>().norm() * tool_->reach_from_centre_m() / tool_->spread_m();
}

void ToolProxy::move(const Twist& twist) noexcept {
  const Point centre = centre_m() + twist.head<3>();
  const Eigen::Quaterniond turn = control::turn_by(twist.tail<3>() / tool_->spread_m());
  pose_.rotation = (turn * Eigen::Quaterniond(pose_.rotation)).normalized().toRotationMatrix();
  pose_.tip_m = centre - pose_.rotation * tool_->centre_m();
}

void ToolProxy::follow(const ToolPose& device, const Plan& plan, std::span<const std::uint32_t> steps,
                       std::span<std::byte> states) noexcept {
  const Asked asked{plan, steps, states};
  if (!std::exchange(placed_, true)) pose_ = device;
  double moved_m = 0;
  double known_m = 0;
  for (int part = 0; part < kMovesMost; ++part) {
    const Twist wanted = twist_to(device);
    if (part == 0 || moved_m + kSlideMost_m > known_m) {
      known_m = std::clamp(length_m(wanted), 3 * kSlideMost_m, kFreeMost_m);
      moved_m = 0;
      find_near(asked, known_m);
    }
    ask(asked);
    const Twist step = solve(wanted);
    const double step_m = length_m(step);
    if (!(step_m > kStill_m)) break;
    // What is further is not met on the way.
    const double most_m = std::max(kSlideMost_m, std::min(clear_m_, known_m) - moved_m);
    const double share = std::min(1.0, most_m / step_m);
    move(share * step);
    moved_m += share * step_m;
  }
}

void ToolProxy::find_near(const Asked& asked, double margin_m) noexcept {
  for (const std::uint32_t step : asked.steps) {
    if (asked.plan.steps()[step].solid) find_near(asked, step, margin_m);
  }
}

/// Those that touched are asked again in any case.
void ToolProxy::find_near(const Asked& asked, std::uint32_t number, double margin_m) noexcept {
  const PlanStep& step = asked.plan.steps()[number];
  std::vector<Near>& near = near_[number];
  tree_.clear();
  next_.clear();
  tool_->find_near(*step.shape, pose_, margin_m + step.reach_m, tree_);
  auto before = near.begin();
  const auto leave = [&] {
    if (before->share_m > 0) {
      next_.push_back(*before);
    } else {
      asked.run_of(before->point).forget(step);
    }
    ++before;
  };
  for (const std::uint32_t point : tree_) {
    while (before != near.end() && before->point < point) leave();
    if (before != near.end() && before->point == point) {
      next_.push_back(*before++);
      continue;
    }
    asked.run_of(point).begin_outside(step, pose_ * tool_->points()[point].at_m);
    next_.push_back({.point = point});
  }
  while (before != near.end()) leave();
  std::swap(near, next_);
}

void ToolProxy::ask(const Asked& asked) noexcept {
  rows_.clear();
  clear_m_ = std::numeric_limits<double>::infinity();
  const Point centre = centre_m();
  for (const std::uint32_t number : asked.steps) {
    const PlanStep& step = asked.plan.steps()[number];
    if (!step.solid) continue;
    for (Near& near : near_[number]) {
      const ToolPoint& point = tool_->points()[near.point];
      const Point place_m = pose_ * point.at_m;
      near.surface = asked.run_of(near.point).find_surface(step, place_m);
      near.surface.penetration_m += point.radius_m;
      near.arm_m = place_m - centre;
      Row row{.direction = {}, .gap_m = -near.surface.penetration_m, .near = &near};
      clear_m_ = std::min(clear_m_, row.gap_m);
      if (row.gap_m > kSlideMost_m && near.share_m == 0) continue;
      row.direction << near.surface.normal, near.arm_m.cross(near.surface.normal) / tool_->spread_m();
      rows_.push_back(row);
    }
  }
}

/// Of the rows those alone that push or would be broken: few of the many that are near.
ToolProxy::Twist ToolProxy::solve(const Twist& wanted) noexcept {
  Twist step = wanted;
  for (const Row& row : rows_) step += row.near->share_m * row.direction;
  for (int round = 0; round < kRoundsMost; ++round) {
    bool broken = false;
    working_.clear();
    for (const Row& row : rows_) {
      const bool is_broken = row.direction.dot(step) + row.gap_m < -kConverged_m;
      if (is_broken || row.near->share_m > 0) working_.push_back(&row);
      broken = broken || is_broken;
    }
    if (!broken && round > 0) break;
    for (int sweep = 0; sweep < kSweepsMost; ++sweep) {
      if (sweep_working(step) < kConverged_m) break;
    }
  }
  return step;
}

/// @returns the largest change of a share [m]
double ToolProxy::sweep_working(Twist& step) const noexcept {
  double changed_m = 0;
  for (const Row* const row : working_) {
    const double before_m = row->near->share_m;
    const double missing_m = -(row->direction.dot(step) + row->gap_m);
    const double share_m = std::max(0.0, before_m + missing_m / row->direction.squaredNorm());
    step += (share_m - before_m) * row->direction;
    row->near->share_m = share_m;
    changed_m = std::max(changed_m, std::abs(share_m - before_m));
  }
  return changed_m;
}

}  // namespace forcebound::scene
