#pragma once

#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Time for a motion in an empty scene on a present-day machine [ns].
inline constexpr double kMotion_ns = 35;

/// Predicted time that an object or field adds to a motion [ns], from the estimates of its shape and effects.
[[nodiscard]] double predicted_cost_ns(const scene::SceneObject& part);

/// Predicted time for one motion in a scene [ns], from the estimates of its effects, shapes and dynamic models.
[[nodiscard]] double predicted_cost_ns(const scene::Scene& scene);

}  // namespace forcebound::server
