#include "forcebound/client/session/texture.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::client {

control::Vector texture_force_N(const wire::EnvironmentForce& answer, const control::Vector& position) noexcept {
  const control::Vector& normal = answer.contact_normal;
  control::Vector force = control::Vector::Zero(position.rows());
  if (!(answer.texture_N > 0) || normal.rows() == 0 || answer.texture_wave.rows() == 0) return force;
  if (!(answer.penetration_m > normal.dot(position - answer.position))) return force;
  double height = std::sin(answer.texture_wave.dot(position));
  if (answer.texture_across.rows() > 0) height = 0.5 * (height + std::sin(answer.texture_across.dot(position)));
  const double push_N = std::max(0.0, answer.force.dot(normal));
  force = std::max(-push_N, answer.texture_N * height) * normal;
  return force;
}

}  // namespace forcebound::client
