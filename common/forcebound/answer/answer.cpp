#include "forcebound/answer/answer.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/control/translation.hpp"

namespace forcebound::answer {

bool is_sound(const Answer& answer, Eigen::Index rows) noexcept {
  const auto has = [](const Vector& vector, Eigen::Index wanted) {
    return vector.rows() == wanted && vector.allFinite();
  };
  const auto has_or_none = [&](const Vector& vector, Eigen::Index wanted) {
    return vector.rows() == 0 || has(vector, wanted);
  };
  return has(answer.force, rows) && has_or_none(answer.torque_N_m, Eigen::Vector3d::RowsAtCompileTime) &&
         has_or_none(answer.contact_normal, rows) && has_or_none(answer.server_parts_N, rows) &&
         std::isfinite(answer.penetration_m) && answer.penetration_m >= 0 && std::isfinite(answer.texture_N) &&
         answer.texture_N >= 0 && has_or_none(answer.texture_wave, rows) && has_or_none(answer.texture_across, rows);
}

Vector ripples_N(const Answer& answer, const RippledTouch& touch) noexcept {
  const Vector& normal = answer.contact_normal;
  const bool touches = normal.rows() > 0 && answer.penetration_m > normal.dot(touch.position - touch.answered_at);
  if (!touches || !(answer.texture_N > 0) || answer.texture_wave.rows() == 0)
    return Vector::Zero(touch.position.rows());
  const auto height_of = [&](const Vector& wave_rad_per_m) {
    return std::sin(control::translation_of(wave_rad_per_m).dot(control::translation_of(touch.position)));
  };
  double height = height_of(answer.texture_wave);
  if (answer.texture_across.rows() > 0) height = (height + height_of(answer.texture_across)) / 2;
  const double push_N = std::max(0.0, touch.pushing_N.dot(normal));
  return std::max(-push_N, answer.texture_N * height) * normal;
}

}  // namespace forcebound::answer
