#include "forcebound/server/scene/scene_state.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace forcebound::server {
namespace {

/// Wrapped around where a stranger's times lie further apart than 64 bits hold.
double seconds_between(Nanoseconds from, Nanoseconds to) noexcept {
  const auto elapsed =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(to.count()) - static_cast<std::uint64_t>(from.count()));
  return elapsed > 0 ? static_cast<double>(elapsed) * 1e-9 : 0;
}

}  // namespace

SceneState::SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom)
    : scene_(std::move(scene)),
      rows_(degrees_of_freedom),
      translations_(std::min<Eigen::Index>(rows_, 3)),
      bytes_(scene_->plan().state_bytes()),
      steps_(scene_->plan().steps().size()) {
  std::iota(steps_.begin(), steps_.end(), 0U);
}

SceneState SceneState::of_step(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom, std::size_t step) {
  SceneState state(std::move(scene), degrees_of_freedom);
  state.steps_ = {static_cast<std::uint32_t>(step)};
  return state;
}

SceneAnswer SceneState::answer(const Vector& position, Nanoseconds device_time) noexcept {
  const Plan& plan = scene_->plan();
  Probe probe;
  probe.position_m.head(translations_) = position.head(translations_);
  if (plan.inputs().velocity || plan.inputs().time) look_at_time(probe, device_time);

  Point total = Point::Zero();
  SceneAnswer answer;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const PlanStep& step = plan.steps()[steps_[i]];
    Reaction reaction;
    const SurfacePoint surface = find_surface(step, probe.position_m);
    probe.normal = surface.normal;
    probe.penetration_m = surface.penetration_m;
    act(step, probe, reaction);
    if (!surface.normal.allFinite() || !(total + reaction.force_N).allFinite()) {
      ++faults_.quarantined;
      answer.quarantined = &scene_->name_of_step(steps_[i]);
      steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(i--));
      continue;
    }
    total += reaction.force_N;
    if (!(surface.penetration_m > 0)) continue;
    if (surface.normal_is_old) ++faults_.old_normals;
    if (surface.penetration_m > answer.penetration_m) {
      answer.penetration_m = surface.penetration_m;
      answer.contact_normal = in_device_rows(surface.normal);
      answer.texture = reaction.texture;
    }
  }
  answer.force = in_device_rows(total);
  return answer;
}

Vector SceneState::in_device_rows(const Point& point) const noexcept {
  Vector vector = Vector::Zero(rows_);
  vector.head(translations_) = point.head(translations_);
  return vector;
}

SurfacePoint SceneState::find_surface(const PlanStep& step, const Point& position_m) noexcept {
  if (step.shape == nullptr) return {};
  return step.shape->nearest(position_m, bytes_.data() + step.shape_state);
}

void SceneState::act(const PlanStep& step, Probe& probe, Reaction& reaction) noexcept {
  if (step.shape != nullptr && !(probe.penetration_m > -step.reach_m)) {
    forget(step.near_state, step.end_state);
    return;
  }
  run(step.begin, step.near_end, probe, reaction);
  if (!(probe.penetration_m > 0)) {
    forget(step.touching_state, step.end_state);
    return;
  }
  run(step.near_end, step.touching_end, probe, reaction);
  probe.pressure_N = std::max(0.0, reaction.force_N.dot(probe.normal));
  run(step.touching_end, step.end, probe, reaction);
}

void SceneState::run(std::uint32_t begin, std::uint32_t end, const Probe& probe, Reaction& reaction) noexcept {
  for (std::uint32_t i = begin; i < end; ++i) {
    const PlannedEffect& planned = scene_->plan().effects()[i];
    planned.effect->act(probe, bytes_.data() + planned.state, reaction);
  }
}

void SceneState::forget(std::uint32_t begin, std::uint32_t end) noexcept {
  std::fill(bytes_.begin() + begin, bytes_.begin() + end, std::byte{0});
}

void SceneState::look_at_time(Probe& probe, Nanoseconds device_time) noexcept {
  if (has_last_) {
    probe.interval_s = seconds_between(last_time_, device_time);
    probe.time_s = seconds_between(first_time_, device_time);
    if (probe.interval_s > 0) probe.velocity_m_per_s = (probe.position_m - last_position_m_) / probe.interval_s;
  } else {
    first_time_ = device_time;
  }
  has_last_ = true;
  last_time_ = device_time;
  last_position_m_ = probe.position_m;
}

}  // namespace forcebound::server
