#include "forcebound/server/session/answer_size.hpp"

#include <algorithm>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {
namespace {

constexpr std::size_t kIpAndUdpBytes = 28;

/// The waves of the texture that any object of the scene can show: a touch of each object tells.
int waves_of(const scene::Scene& scene) {
  int waves = 0;
  for (const scene::SceneObject& object : scene.objects()) {
    for (const scene::RequestedEffect& requested : object.effects) {
      std::vector<double> state(requested.effect->facts().state_bytes / sizeof(double) + 1);
      scene::Reaction reaction;
      // Oblique, so that no direction of ripples is along the normal.
      const scene::Probe probe{.normal = scene::Point(0.48, 0.6, 0.64), .penetration_m = 1e-3, .pressure_N = 1};
      requested.effect->act(probe, reinterpret_cast<std::byte*>(state.data()), reaction);
      if (reaction.texture.amplitude_N > 0) waves = std::max(waves, reaction.texture.waves);
    }
  }
  return waves;
}

}  // namespace

std::size_t answer_bytes(const scene::Scene& scene) {
  const int wanted = scene.facts().degrees_of_freedom;
  const auto rows = static_cast<Eigen::Index>(wanted == scene::kAnyDegreesOfFreedom ? 1 : wanted);
  const control::Vector any = control::Vector::Constant(rows, 0.1);
  // Counts and times one minute into a session: their encoded lengths stay the same for hours.
  constexpr std::uint64_t kCount = 60'000;
  constexpr time::Nanoseconds kTime = std::chrono::hours{100};
  const int waves = waves_of(scene);
  const wire::EnvironmentForce force{.session = ~std::uint64_t{0},
                                     .sequence = kCount,
                                     .motion_sequence = kCount,
                                     .motion_device_time = kTime,
                                     .position = any,
                                     .server_receive_time = kTime,
                                     .server_send_time = kTime,
                                     .compute_time = std::chrono::microseconds{1},
                                     .motions_received = kCount,
                                     .motions_duplicated = 0,
                                     .motions_reordered = 0,
                                     .answer = {.force = any,
                                                .contact_normal = any,
                                                .penetration_m = 1e-3,
                                                .texture_N = waves > 0 ? 1.0 : 0.0,
                                                .texture_wave = waves > 0 ? any : control::Vector(),
                                                .texture_across = waves > 1 ? any : control::Vector()}};
  wire::Codec codec;
  return codec.encode(force).size() + kIpAndUdpBytes;
}

}  // namespace forcebound::server
