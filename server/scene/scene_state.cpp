#include "forcebound/server/scene/scene_state.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::server {

SceneState::SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom)
    : scene_(std::move(scene)),
      rows_(degrees_of_freedom),
      translations_(std::min<Eigen::Index>(rows_, 3)),
      last_normals_(scene_->steps().size(), Point::UnitX()) {}

SceneAnswer SceneState::answer(const Vector& position, Nanoseconds device_time) noexcept {
  Probe probe{.position_m = Point::Zero(), .velocity_m_per_s = Point::Zero(), .normal = Point::UnitX()};
  probe.position_m.head(translations_) = position.head(translations_);
  if (scene_->needs_velocity()) probe.velocity_m_per_s = velocity_at(probe.position_m, device_time);

  Point total = Point::Zero();
  SceneAnswer answer{.force = Vector::Zero(rows_), .contact_normal = {}};
  std::size_t effect = 0;
  for (std::size_t i = 0; i < scene_->steps().size(); ++i) {
    const PlanStep& step = scene_->steps()[i];
    const SurfacePoint surface = step.shape->nearest(probe.position_m, last_normals_[i]);
    if (!(surface.penetration_m > 0)) {
      effect = step.effects_end;
      continue;
    }
    probe.normal = surface.normal;
    probe.penetration_m = surface.penetration_m;
    Point force = Point::Zero();
    for (; effect < step.effects_end; ++effect) force += scene_->effects()[effect]->force_N(probe);
    if (!force.allFinite() || !surface.normal.allFinite() || !(total + force).allFinite()) {
      ++faults_.non_finite_forces;
      continue;
    }
    total += force;
    last_normals_[i] = surface.normal;
    if (surface.normal_is_old) ++faults_.old_normals;
    if (surface.penetration_m > answer.penetration_m) {
      answer.penetration_m = surface.penetration_m;
      answer.contact_normal = Vector::Zero(rows_);
      answer.contact_normal.head(translations_) = surface.normal.head(translations_);
    }
  }
  answer.force.head(translations_) = total.head(translations_);
  return answer;
}

Point SceneState::velocity_at(const Point& position_m, Nanoseconds device_time) noexcept {
  // Unsigned, because a stranger's times may lie further apart than 64 bits hold.
  const auto elapsed = static_cast<std::int64_t>(static_cast<std::uint64_t>(device_time.count()) -
                                                 static_cast<std::uint64_t>(last_time_.count()));
  const bool known = has_last_ && elapsed > 0;
  const Point velocity =
      known ? Point((position_m - last_position_m_) / (static_cast<double>(elapsed) * 1e-9)) : Point(Point::Zero());
  has_last_ = true;
  last_time_ = device_time;
  last_position_m_ = position_m;
  return velocity;
}

}  // namespace forcebound::server
