#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/scene/auto_accuracy.hpp"
#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/scene/plan.hpp"
#include "forcebound/scene/rendering.hpp"

namespace forcebound::scene {

class Tool;

/// The [scene] table of a scene file.
struct SceneFacts {
  std::string name;
  std::string description;
  int degrees_of_freedom = 3;          ///< 1 to 3, or kAnyDegreesOfFreedom
  bool shared = false;                 ///< all clients feel the same bodies and tissue
  bool accuracy_auto = false;          ///< has levels of accuracy, see Scene::accuracy
  int clients_max = 1;                 ///< of a shared scene, at once; else any number
  control::Vector tool_m{};            ///< in the hand, from the grip to its tip in the handle's axes; no rows: none
  std::shared_ptr<const Tool> tool{};  ///< its shape, about the tip; null: it touches with that point
  std::uint64_t hash = 0;              ///< FNV-1a of the file's text: equal hash, equal scene
  std::string suggested_device{};      ///< as the author wrote them; empty: see suggested_hand.hpp
  std::string suggested_hand{};
  std::vector<std::string> effects_not_requested{};

  /// Whether the scene accepts a device with that number of degrees of freedom: the same number, or 6 where the scene
  /// has 3.
  [[nodiscard]] bool accepts(std::uint32_t device_degrees_of_freedom) const noexcept;

  /// What `accepts` accepts, as text: "3 or 6".
  [[nodiscard]] std::string accepted_degrees_of_freedom() const;
};

inline constexpr int kAnyDegreesOfFreedom = 0;

/// A dynamic model of a scene: a [[tissue]], all [[body]]s with shapes together, or a [[body]] of an MJCF file.
struct SceneDynamicModel {
  std::string name;
  std::string text;  ///< "tissue, file liver.msh, young_Pa 5000, ..."
  std::unique_ptr<DynamicModel> dynamic_model;
};

/// The parts of a scene.
struct SceneParts {
  std::vector<SceneObject> objects{};
  std::vector<SceneObject> fields{};
  std::vector<SceneDynamicModel> dynamic_models{};
};

/// A scene and its plan. Immutable, shared by all clients.
class Scene {
 public:
  /// @param accuracy levels of accuracy; empty: only one
  Scene(SceneFacts facts, SceneParts parts, AutoAccuracy accuracy = {});

  [[nodiscard]] const SceneFacts& facts() const noexcept { return facts_; }
  [[nodiscard]] const std::vector<SceneObject>& objects() const noexcept { return parts_.objects; }
  [[nodiscard]] const std::vector<SceneObject>& fields() const noexcept { return parts_.fields; }
  [[nodiscard]] const std::vector<SceneDynamicModel>& dynamic_models() const noexcept { return parts_.dynamic_models; }
  [[nodiscard]] const Plan& plan() const noexcept { return plan_; }

  /// The levels of accuracy that round trips choose between; null: only one.
  [[nodiscard]] const AutoAccuracy* accuracy() const noexcept {
    return accuracy_.levels.empty() ? nullptr : &accuracy_;
  }

  /// The inputs that any effect or dynamic model uses.
  [[nodiscard]] const Inputs& inputs() const noexcept { return inputs_; }

  /// Name of the object or field of a step of the plan.
  [[nodiscard]] const std::string& name_of_step(std::size_t step) const noexcept;

  /// The number of parts: the steps of the plan, then the dynamic models.
  [[nodiscard]] std::size_t parts() const noexcept { return plan_.steps().size() + parts_.dynamic_models.size(); }

  /// Where the force of a part is computed if the client renders locally.
  [[nodiscard]] const PartRendering& rendering_of_part(std::size_t part) const { return renderings_.at(part); }

  /// The least of them: `held` if some part is, else `modelled` if some part is.
  [[nodiscard]] Rendering least_rendering() const noexcept;

  /// Whether some part runs at the client.
  [[nodiscard]] bool can_be_handed_over() const noexcept;

  /// Where a device first meets a part; the origin for a field.
  [[nodiscard]] Point on_surface_m(std::size_t part) const;

  [[nodiscard]] bool accepts(std::uint32_t device_degrees_of_freedom) const noexcept {
    return facts_.accepts(device_degrees_of_freedom);
  }
  [[nodiscard]] std::string accepted_degrees_of_freedom() const { return facts_.accepted_degrees_of_freedom(); }

 private:
  SceneFacts facts_;
  SceneParts parts_;
  Plan plan_;
  Inputs inputs_;
  AutoAccuracy accuracy_;
  std::vector<PartRendering> renderings_;  // of all parts
};

}  // namespace forcebound::scene
