#pragma once

#include "forcebound/scene/scene.hpp"

namespace forcebound::scene {

/// Time for a motion in an empty scene on a present-day machine [ns].
inline constexpr double kMotion_ns = 35;

/// Predicted time that an object or field adds to a motion [ns], from the estimates of its shape and effects.
[[nodiscard]] double predicted_cost_ns(const SceneObject& part);

/// Predicted time that a dynamic model adds to a motion that is answered with a local model [ns], from its own
/// estimates.
[[nodiscard]] double predicted_cost_ns(const DynamicModelFacts& facts);

/// Predicted time for one motion in a scene [ns], from the estimates of its effects, shapes and dynamic models;
/// answered as to a client that renders locally.
[[nodiscard]] double predicted_cost_ns(const Scene& scene);

}  // namespace forcebound::scene
