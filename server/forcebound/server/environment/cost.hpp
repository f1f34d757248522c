#pragma once

#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// What every motion takes, before any part, on a machine of today [ns].
inline constexpr double kMotion_ns = 35;

/// What an object or field is expected to take of a motion [ns], as its shape and effects say.
[[nodiscard]] double predicted_cost_ns(const scene::SceneObject& part);

/// What a motion is expected to take for all that a scene has [ns], as its effects, shapes and dynamic models say.
[[nodiscard]] double predicted_cost_ns(const scene::Scene& scene);

}  // namespace forcebound::server
