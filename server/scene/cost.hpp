#pragma once

#include "forcebound/server/scene/scene.hpp"

namespace forcebound::server {

/// What every motion takes, before any part, on a machine of today [ns].
inline constexpr double kMotion_ns = 35;

/// What an object or field is expected to take of a motion [ns], as its shape and effects say.
[[nodiscard]] double predicted_cost_ns(const SceneObject& part);

/// What a motion is expected to take for all that a scene has [ns], as its effects, shapes and media say.
[[nodiscard]] double predicted_cost_ns(const Scene& scene);

}  // namespace forcebound::server
