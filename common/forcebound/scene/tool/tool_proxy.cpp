#include "forcebound/scene/tool/tool_proxy.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "forcebound/control/rotation.hpp"

namespace forcebound::scene {
namespace {

// Less than a point moves by rounding, and than anybody feels.
constexpr double kStill_m = 1e-8;
// In free space a tool goes as far at once, if nothing is nearer.
constexpr double kFreeMost_m = 0.01;

}  // namespace

ToolProxy::ToolProxy(std::shared_ptr<const Tool> tool, const Scene& scene)
    : tool_(std::move(tool)),
      edges_(*tool_, scene.objects()),
      near_(scene.plan().steps().size()),
      near_edges_(near_.size()),
      states_(near_.size()) {
  const std::size_t points = tool_->points().size();
  std::size_t rows = 0;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    if (!scene.plan().steps()[i].solid) continue;
    near_[i].reserve(points);
    near_edges_[i].reserve(edges_.contacts_most());
    rows += points + edges_.contacts_most();
  }
  next_.reserve(points);
  next_edges_.reserve(edges_.contacts_most());
  found_.reserve(edges_.contacts_most());
  tree_.reserve(points);
  rows_.reserve(rows);
  of_rows_.reserve(rows);
}

void ToolProxy::begin_again() noexcept {
  for (std::vector<Near>& near : near_) near.clear();
  for (std::vector<NearEdge>& near : near_edges_) near.clear();
  std::ranges::fill(states_, 0U);
  placed_ = false;
}

void ToolProxy::go_on_from(const ToolProxy& other) noexcept {
  // No larger than what was reserved, so nothing is allocated.
  for (std::size_t i = 0; i < near_.size(); ++i) near_[i].assign(other.near_[i].begin(), other.near_[i].end());
  for (std::size_t i = 0; i < near_edges_.size(); ++i) {
    const auto& from = other.near_edges_[i];
    const std::size_t most = std::min(from.size(), near_edges_[i].capacity());
    near_edges_[i].assign(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(most));
  }
  states_ = other.states_;
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

void ToolProxy::follow(const ToolPose& from, const ToolPose& device, const Plan& plan,
                       std::span<const std::uint32_t> steps, std::span<std::byte> states) noexcept {
  const Asked asked{plan, steps, states};
  if (!std::exchange(placed_, true)) pose_ = is_clear(asked, device) ? device : from;
  double moved_m = 0;
  double known_m = 0;
  for (int part = 0; part < kMovesMost; ++part) {
    const Twist wanted = twist_to(device);
    if (part == 0 || moved_m + kSlideMost_m > known_m) {
      known_m = std::clamp(length_m(wanted), 3 * kSlideMost_m, kFreeMost_m);
      moved_m = 0;
      find_near(asked, known_m);
    }
    ask(asked, std::max(kSlideMost_m, known_m - moved_m));
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

/// As far as that can be told without the states.
bool ToolProxy::is_clear(const Asked& asked, const ToolPose& pose) noexcept {
  return std::ranges::none_of(asked.steps, [&](std::uint32_t number) {
    const PlanStep& step = asked.plan.steps()[number];
    if (!step.solid) return false;
    tree_.clear();
    tool_->find_near(*step.shape, pose, 0, tree_);
    return !tree_.empty();
  });
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
  const bool by_edges = edges_.knows(number);
  if (!by_edges || !tool_->all_in_parts()) tool_->find_near(*step.shape, pose_, margin_m + step.reach_m, tree_);
  if (by_edges) std::erase_if(tree_, [this](std::uint32_t point) { return tool_->is_in_part(point); });
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
    next_.push_back({{}, point});
  }
  while (before != near.end()) leave();
  std::swap(near, next_);
}

void ToolProxy::ask(const Asked& asked, double margin_m) noexcept {
  rows_.clear();
  of_rows_.clear();
  clear_m_ = std::numeric_limits<double>::infinity();
  const Point centre = centre_m();
  for (const std::uint32_t number : asked.steps) {
    const PlanStep& step = asked.plan.steps()[number];
    if (!step.solid) continue;
    const double rounded_m = edges_.has_normals(number) ? 0 : ToolEdges::kRounded_m;
    for (Near& near : near_[number]) {
      const ToolPoint& point = tool_->points()[near.point];
      const Point place_m = pose_ * point.at_m;
      near.surface = asked.run_of(near.point).find_surface(step, place_m);
      near.surface.penetration_m += std::max(point.radius_m, rounded_m);
      near.arm_m = place_m - centre;
      add_row(near);
    }
    if (edges_.knows(number)) ask_edges(asked, number, margin_m);
    for (NearEdge& edge : near_edges_[number]) add_row(edge);
  }
}

void ToolProxy::add_row(Contact& contact) noexcept {
  const double gap_m = -contact.surface.penetration_m;
  clear_m_ = std::min(clear_m_, gap_m);
  if (gap_m > kSlideMost_m && contact.share_m == 0) return;
  NearestStep::Row row{.gap_m = gap_m, .share_m = contact.share_m};
  row.direction << contact.surface.normal, contact.arm_m.cross(contact.surface.normal) / tool_->spread_m();
  rows_.push_back(row);
  of_rows_.push_back(&contact);
}

/// Contacts go on by their keys.
void ToolProxy::ask_edges(const Asked& asked, std::uint32_t number, double margin_m) noexcept {
  const PlanStep& step = asked.plan.steps()[number];
  std::vector<NearEdge>& near = near_edges_[number];
  found_.clear();
  next_edges_.clear();
  edges_.find(number, pose_, std::max(margin_m, step.reach_m), kSlideMost_m, found_);
  auto before = near.begin();
  const Point centre = centre_m();
  const auto leave = [&] {
    if (before->state < kEdgeStates) {
      PlanRun(asked.plan, asked.states.data() + state_of(*before) * asked.plan.state_bytes()).forget(step);
      states_[number] &= ~(std::uint64_t{1} << before->state);
    }
    ++before;
  };
  for (const EdgeContact& found : found_) {
    while (before != near.end() && before->key < found.key) leave();
    NearEdge next;
    if (before != near.end() && before->key == found.key) next = *before++;
    next.key = found.key;
    next.surface = {.normal = found.normal, .penetration_m = -found.gap_m};
    next.arm_m = found.at_m - centre;
    next.in_handle_m = pose_.rotation.transpose() * (found.at_m - pose_.tip_m);
    next_edges_.push_back(next);
  }
  while (before != near.end()) leave();
  std::swap(near, next_edges_);
}

void ToolProxy::keep_state(NearEdge& edge, const Plan& plan, std::size_t step, std::span<std::byte> states) noexcept {
  if (edge.state < kEdgeStates) return;
  edge.state = std::min(static_cast<std::uint32_t>(std::countr_one(states_[step])), kEdgeStates);
  if (edge.state < kEdgeStates) states_[step] |= std::uint64_t{1} << edge.state;
  PlanRun(plan, states.data() + state_of(edge) * plan.state_bytes()).forget(plan.steps()[step]);
}

ToolProxy::Twist ToolProxy::solve(const Twist& wanted) noexcept {
  const Twist step = nearest_.solve(wanted, rows_);
  for (std::size_t i = 0; i < rows_.size(); ++i) of_rows_[i]->share_m = rows_[i].share_m;
  return step;
}

}  // namespace forcebound::scene
