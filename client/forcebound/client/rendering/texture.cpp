#include "forcebound/client/rendering/texture.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/client/rendering/device_point.hpp"

namespace forcebound::client {

Vector ripples_N(const scene::Texture& texture, const Contact& contact, const Vector& position) noexcept {
  Vector force = Vector::Zero(position.rows());
  if (!(texture.amplitude_N > 0) || texture.waves == 0 || contact.normal.rows() == 0) return force;
  const Point place_m = translation_of(position);
  double height = 0;
  for (int i = 0; i < texture.waves; ++i)
    height += std::sin(texture.waves_rad_per_m.at(static_cast<std::size_t>(i)).dot(place_m));
  height /= texture.waves;
  const double push_N = std::max(0.0, contact.pushing_N.dot(contact.normal));
  force = std::max(-push_N, texture.amplitude_N * height) * contact.normal;
  return force;
}

Vector texture_force_N(const wire::EnvironmentForce& answer, const Vector& pushing_N, const Vector& position) noexcept {
  const Vector& normal = answer.contact_normal;
  const bool touches = normal.rows() > 0 && answer.penetration_m > normal.dot(position - answer.position);
  if (!touches || answer.texture_wave.rows() == 0) return Vector::Zero(position.rows());
  const scene::Texture texture{
      .amplitude_N = answer.texture_N,
      .waves = answer.texture_across.rows() > 0 ? 2 : 1,
      .waves_rad_per_m = {translation_of(answer.texture_wave), translation_of(answer.texture_across)}};
  return ripples_N(texture, {.normal = normal, .pushing_N = pushing_N}, position);
}

}  // namespace forcebound::client
