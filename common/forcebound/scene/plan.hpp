#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "forcebound/scene/effects/effect.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// One effect of an object or field, and its description.
struct RequestedEffect {
  std::string name;
  config::Values values;  ///< as they were given, without presets
  std::string law;
  std::string parameters;  ///< "stiffness_N_per_m 50000, damping_N_s_per_m 0"
  std::unique_ptr<Effect> effect;
};

/// An [[object]], or a [[field]], which has no shape.
struct SceneObject {
  std::string name;
  std::string shape_kind{};
  double tool_reach_m = 0;        ///< Tool::reach_of_points_m
  config::Values shape_values{};  ///< as they were given, without presets
  std::string shape_text{};       ///< "sphere, center_m [0, 0, 0], radius_m 0.02"
  std::unique_ptr<Shape> shape{};
  std::vector<RequestedEffect> effects{};
};

/// One effect of the flat list.
struct PlannedEffect {
  const Effect* effect;
  std::uint32_t state;  ///< where its state begins in a session's bytes
  bool fades_without_server;
};

/// One object or field. Its effects follow each other in the flat list: up to `near_end` those that also act above the
/// surface, up to `touching_end` those that act within, up to `end` those that need the pressure of the others. Their
/// states follow each other in the same order.
struct PlanStep {
  const Shape* shape;  ///< null: a field, whose effects all lie between `begin` and `near_end`
  bool solid;          ///< an object of which an effect is
  double reach_m;      ///< largest reach of its effects above the surface
  std::uint32_t begin;
  std::uint32_t near_end;
  std::uint32_t touching_end;
  std::uint32_t end;
  std::uint32_t shape_state;
  std::uint32_t near_state;      ///< reset out of reach, up to `touching_state`
  std::uint32_t touching_state;  ///< reset without contact, up to `end_state`
  std::uint32_t end_state;
};

/// The objects and fields of a scene, compiled to flat lists: an effect that no part uses takes neither time nor
/// memory.
class Plan {
 public:
  Plan() = default;

  /// The parts must outlive the plan.
  Plan(std::span<const SceneObject> objects, std::span<const SceneObject> fields);

  [[nodiscard]] std::span<const PlanStep> steps() const noexcept { return steps_; }
  [[nodiscard]] std::span<const PlannedEffect> effects() const noexcept { return effects_; }

  /// The inputs that any effect uses.
  [[nodiscard]] const Inputs& inputs() const noexcept { return inputs_; }

  /// Whether any effect does.
  [[nodiscard]] bool fades_without_server() const noexcept { return fades_without_server_; }

  /// Bytes of state for each session.
  [[nodiscard]] std::size_t state_bytes() const noexcept { return state_bytes_; }

 private:
  void add(const SceneObject& part);
  std::uint32_t keep(std::size_t bytes);
  template <class Wanted>
  void add_effects(const SceneObject& part, Wanted wanted);

  std::vector<PlanStep> steps_;
  std::vector<PlannedEffect> effects_;
  Inputs inputs_;
  bool fades_without_server_ = false;
  std::size_t state_bytes_ = 0;
};

}  // namespace forcebound::scene
