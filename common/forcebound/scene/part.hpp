#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/plan.hpp"
#include "forcebound/scene/registry.hpp"

namespace forcebound::scene {

/// A registered shape or effect, and the values that are given for it; presets may be left out.
struct NamedValues {
  std::string name;
  config::Values values{};

  friend bool operator==(const NamedValues&, const NamedValues&) = default;
};

/// All there is to say of an object or field: what a file or a message has of it.
struct PartDescription {
  std::string name;
  std::optional<NamedValues> shape{};  ///< none: a field
  std::vector<NamedValues> effects{};

  friend bool operator==(const PartDescription&, const PartDescription&) = default;
};

/// Of a part that was made.
[[nodiscard]] PartDescription describe(const SceneObject& part);

/// The part that is described: everything is checked, whoever may have said it.
/// @param axes of the scene, 1 to 3: on the others points are zero, and boxes have no faces
/// @param folder in which the files lie that a shape names
/// @throws config::ValueError, or another std::invalid_argument or std::runtime_error, in one line
[[nodiscard]] SceneObject make_part(const PartDescription& description, const Registry& registry, Eigen::Index axes = 3,
                                    const std::string& folder = {});

// Its steps, for those who have to say in which line of a file something is wrong. They throw as `make_part` does.

/// An effect that a part may have beside those it has.
/// @param of_surfaces_too whether it is for an object
[[nodiscard]] const EffectKind& effect_kind(const Registry& registry, std::string_view name, bool of_surfaces_too,
                                            const SceneObject& part);

/// The names that `effect_kind` accepts.
[[nodiscard]] std::vector<std::string> effect_names(const Registry& registry, bool of_surfaces_too);

void add_effect(SceneObject& part, const EffectKind& kind, const config::Values& given, Eigen::Index axes);

[[nodiscard]] const ShapeKind& shape_kind(const Registry& registry, std::string_view name, Eigen::Index axes);

/// That an object's effects have what they depend on.
void check_effects(const SceneObject& part);

/// After all effects.
void set_shape(SceneObject& part, const ShapeKind& kind, const config::Values& given, Eigen::Index axes,
               const std::string& folder);

}  // namespace forcebound::scene
