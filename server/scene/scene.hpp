#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forcebound/server/effects/effect.hpp"
#include "forcebound/server/geometry/shape.hpp"

namespace forcebound::server {

/// One effect that an object asked for, and the words for it.
struct RequestedEffect {
  std::string name;
  std::string law;
  std::string parameters;  ///< "stiffness_N_per_m 50000, damping_N_s_per_m 0"
  std::unique_ptr<Effect> effect;
};

struct SceneObject {
  std::string name;
  std::string shape_text;  ///< "sphere, center_m [0, 0, 0], radius_m 0.02"
  std::unique_ptr<Shape> shape;
  std::vector<RequestedEffect> effects;
};

/// What a scene's author wrote about the whole.
struct SceneFacts {
  std::string name;
  std::string description;
  int degrees_of_freedom = 3;  ///< 1 to 3, or kAnyDegreesOfFreedom
  std::uint64_t hash = 0;      ///< FNV-1a of the file's text: the same hash, the same scene
  std::vector<std::string> effects_not_requested{};
};

inline constexpr int kAnyDegreesOfFreedom = 0;

/// One contact of the plan: a shape, and how far its effects reach in the flat list of effects.
struct PlanStep {
  const Shape* shape;
  std::size_t effects_end;
};

/// A scene, compiled: exactly what its objects asked for as flat lists, and nothing else. Immutable, shared by all
/// clients.
class Scene {
 public:
  Scene(SceneFacts facts, std::vector<SceneObject> objects);

  [[nodiscard]] const SceneFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const std::vector<SceneObject>& objects() const noexcept { return objects_; }

  /// Whether a device of so many degrees of freedom can feel it: the same number, or 6 where the scene has 3.
  [[nodiscard]] bool accepts(std::uint32_t device_degrees_of_freedom) const noexcept;

  /// What `accepts` accepts, for people: "3 or 6".
  [[nodiscard]] std::string accepted_degrees_of_freedom() const;

  [[nodiscard]] std::span<const PlanStep> steps() const noexcept { return steps_; }
  [[nodiscard]] std::span<const Effect* const> effects() const noexcept { return effects_; }
  [[nodiscard]] bool needs_velocity() const noexcept { return needs_velocity_; }

 private:
  SceneFacts facts_;
  std::vector<SceneObject> objects_;
  std::vector<PlanStep> steps_;
  std::vector<const Effect*> effects_;
  bool needs_velocity_ = false;
};

}  // namespace forcebound::server
