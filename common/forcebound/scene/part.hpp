#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/plan.hpp"
#include "forcebound/scene/registry.hpp"

namespace forcebound::scene {

/// A registered shape or effect, and its values; values with a preset may be absent.
struct NamedValues {
  std::string name;
  config::Values values{};
};

/// Description of an object or field, for programs that make their own.
struct PartDescription {
  std::string name;
  std::optional<NamedValues> shape{};  ///< none: a field
  std::vector<NamedValues> effects{};
  double tool_reach_m = 0;  ///< SceneObject::tool_reach_m
};

/// Makes the described part. Every value is checked.
/// @param axes of the scene, 1 to 3: on the others points are zero, and boxes have no faces
/// @param folder paths among a shape's values are relative to it
/// @param geometry the shape's, in place of what its values name (Shape::geometry); none: its values are enough
/// @throws config::ValueError, or another std::invalid_argument or std::runtime_error, in one line
[[nodiscard]] SceneObject make_part(const PartDescription& description, const Registry& registry, Eigen::Index axes = 3,
                                    const std::string& folder = {}, const ShapeGeometry& geometry = {});

// The steps of `make_part`, for readers of files, which give the line of an error, and of messages. They throw as it
// does.

/// Finds an effect and checks that the part may have it beside those it has.
/// @param for_object whether it is for an object
[[nodiscard]] const EffectKind& effect_kind(const Registry& registry, std::string_view name, bool for_object,
                                            const SceneObject& part);

/// The names that `effect_kind` accepts.
[[nodiscard]] std::vector<std::string> effect_names(const Registry& registry, bool for_object);

void add_effect(SceneObject& part, const EffectKind& kind, const config::Values& given, Eigen::Index axes);

/// The names that `shape_kind` knows.
[[nodiscard]] std::vector<std::string> shape_names(const Registry& registry);

[[nodiscard]] const ShapeKind& shape_kind(const Registry& registry, std::string_view name, Eigen::Index axes);

/// Checks that the part has the effects on which its effects depend.
void check_effects(const SceneObject& part);

/// Completes the part after its last effect.
void set_shape(SceneObject& part, const ShapeKind& kind, const config::Values& given, Eigen::Index axes,
               const std::string& folder, const ShapeGeometry& geometry = {});

}  // namespace forcebound::scene
