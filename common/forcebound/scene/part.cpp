#include "forcebound/scene/part.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/text/names.hpp"

namespace forcebound::scene {

SceneObject make_part(const PartDescription& description, const Registry& registry, Eigen::Index axes,
                      const std::string& folder, const ShapeGeometry& geometry) {
  SceneObject part{.name = description.name, .tool_reach_m = description.tool_reach_m};
  const bool is_object = description.shape.has_value();
  for (const NamedValues& effect : description.effects) {
    add_effect(part, effect_kind(registry, effect.name, is_object, part), effect.values, axes);
  }
  if (is_object) {
    check_effects(part);
    const auto& [kind, values] = *description.shape;
    set_shape(part, shape_kind(registry, kind, axes), values, axes, folder, geometry);
  }
  return part;
}

std::vector<std::string> effect_names(const Registry& registry, bool for_object) {
  std::vector<std::string> names;
  for (const EffectKind& kind : registry.effects()) {
    if (for_object || kind.place == EffectPlace::space) names.emplace_back(kind.name);
  }
  return names;
}

const EffectKind& effect_kind(const Registry& registry, std::string_view name, bool for_object,
                              const SceneObject& part) {
  const EffectKind* const kind = registry.find_effect(name);
  const std::vector<std::string> known = effect_names(registry, for_object);
  const std::string quoted = "'" + std::string(name) + "'";
  if (kind == nullptr) throw std::invalid_argument("unknown effect " + quoted + text::suggestion(name, known));
  if (std::ranges::find(part.effects, name, &RequestedEffect::name) != part.effects.end()) {
    throw std::invalid_argument("effect " + quoted + " is asked for twice");
  }
  if (for_object || kind->place == EffectPlace::space) return *kind;
  throw std::invalid_argument("effect " + quoted +
                              " needs the surface of an object, a field may have: " + text::join(known));
}

void add_effect(SceneObject& part, const EffectKind& kind, const config::Values& given, Eigen::Index axes) {
  part.effects.push_back({.name = std::string(kind.name),
                          .values = given,
                          .law = std::string(kind.law),
                          .parameters = config::to_text(kind.parameters, given, axes),
                          .effect = kind.make(config::completed(kind.parameters, given))});
}

// What depends on how hard the others push has nothing to depend on without them.
void check_effects(const SceneObject& part) {
  const auto pushes = [](const RequestedEffect& effect) { return !effect.effect->facts().inputs.pressure; };
  if (part.effects.empty() || std::ranges::any_of(part.effects, pushes)) return;
  throw std::invalid_argument("effect '" + part.effects.front().name +
                              "' needs another one that pushes, such as 'surface': its force depends on the pressure");
}

std::vector<std::string> shape_names(const Registry& registry) {
  std::vector<std::string> names;
  names.reserve(registry.shapes().size());
  for (const ShapeKind& kind : registry.shapes()) names.emplace_back(kind.name);
  return names;
}

const ShapeKind& shape_kind(const Registry& registry, std::string_view name, Eigen::Index axes) {
  const ShapeKind* const kind = registry.find_shape(name);
  if (kind == nullptr) {
    const std::string suggestion = text::suggestion(name, shape_names(registry));
    throw std::invalid_argument("unknown kind '" + std::string(name) + "'" + suggestion);
  }
  if (axes >= kind->axes_least) return *kind;
  throw std::invalid_argument("a " + std::string(name) + " needs a scene of at least " +
                              std::to_string(kind->axes_least) + " degrees of freedom, this one has " +
                              std::to_string(axes));
}

void set_shape(SceneObject& part, const ShapeKind& kind, const config::Values& given, Eigen::Index axes,
               const std::string& folder, const ShapeGeometry& geometry) {
  if (geometry.kind() != GeometryKind::none && geometry.kind() != kind.geometry) {
    throw std::invalid_argument("a " + std::string(kind.name) + " is not made of " +
                                (geometry.mesh ? "triangles" : "heights"));
  }
  ShapePurpose purpose{.reach_m = part.tool_reach_m, .folder = folder, .geometry = geometry};
  for (const RequestedEffect& effect : part.effects) {
    purpose.reach_m = std::max(purpose.reach_m, effect.effect->facts().reach_m);
  }
  part.shape = kind.make(config::completed(kind.parameters, given), purpose);
  part.shape_kind = kind.name;
  part.shape_values = given;
  part.shape_text = part.shape_kind;
  for (const std::string& text : {config::to_text(kind.parameters, given, axes), part.shape->facts().text}) {
    if (!text.empty()) part.shape_text += ", " + text;
  }
}

}  // namespace forcebound::scene
