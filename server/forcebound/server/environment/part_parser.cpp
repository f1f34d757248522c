#include "forcebound/server/environment/part_parser.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/server/environment/shape_parser.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {

scene::SceneObject PartParser::part(const toml::table& table, const std::string& what) const {
  scene::SceneObject made;
  made.name = CheckedTable(table, file_, what).name("name");
  CheckedTable checked(table, file_, what + " '" + made.name + "'");
  (void)checked.at("name");
  const bool has_surface = what == "object";
  const std::vector<std::string> known = names_of_effects(has_surface);
  const toml::array& effects = checked.array("effects");
  if (effects.empty()) checked.fail(effects, "effects must name at least one of: " + text::join(known));
  for (const toml::node& effect : effects) made.effects.push_back(parse_effect(checked, effect, known, made.effects));
  if (has_surface) {
    refuse_pressure_of_nothing(checked, effects, made.effects);
    parse_shape_of(checked, made);
  }
  refuse_unrequested_tables(checked, table, made.effects);
  checked.refuse_unknown_keys();
  return made;
}

std::vector<std::string> PartParser::names_of_effects(bool of_surfaces_too) const {
  std::vector<std::string> names;
  for (const scene::EffectKind& kind : registry_.kinds()) {
    if (of_surfaces_too || kind.place == scene::EffectPlace::space) names.emplace_back(kind.name);
  }
  return names;
}

void PartParser::parse_shape_of(CheckedTable& object, scene::SceneObject& made) const {
  CheckedTable shape(object.table("shape"), file_, object.place() + ", shape");
  double reach_m = 0;
  for (const scene::RequestedEffect& requested : made.effects) {
    reach_m = std::max(reach_m, requested.effect->facts().reach_m);
  }
  made.shape = parse_shape(shape, rows_, reach_m);
  made.shape_text = shape.text("kind") + ", " + shape.values_text();
  shape.refuse_unknown_keys();
}

scene::RequestedEffect PartParser::parse_effect(CheckedTable& part, const toml::node& wanted,
                                                const std::vector<std::string>& known, const Already& already) const {
  const auto name = wanted.value_exact<std::string>();
  if (!name) part.fail(wanted, "effects must be names, got " + as_written(wanted));
  const scene::EffectKind* kind = registry_.find(*name);
  if (kind == nullptr) part.fail(wanted, "unknown effect '" + *name + "'" + text::suggestion(*name, known));
  if (std::find(known.begin(), known.end(), *name) == known.end()) {
    part.fail(wanted, "effect '" + *name + "' needs the surface of an object, a field may have: " + text::join(known));
  }
  if (std::any_of(already.begin(), already.end(), [&](const auto& effect) { return effect.name == *name; })) {
    part.fail(wanted, "effect '" + *name + "' is asked for twice");
  }
  // An effect whose parameters all have presets needs no table.
  static const toml::table kNoParameters;
  const bool has_table = part.find(*name) != nullptr;
  const bool needs_table = !std::all_of(kind->parameters.begin(), kind->parameters.end(), scene::has_preset);
  const toml::table& table = has_table || needs_table ? part.table(*name) : kNoParameters;
  CheckedTable parameters(table, file_, part.place() + ", effect '" + *name + "'");
  const scene::EffectValues values = parse_values(parameters, *kind);
  parameters.refuse_unknown_keys();
  try {
    return {*name, std::string(kind->law), parameters.values_text(), kind->make(values)};
  } catch (const std::invalid_argument& error) {
    parameters.fail(error.what());
  }
}

scene::EffectValues PartParser::parse_values(CheckedTable& table, const scene::EffectKind& kind) const {
  scene::EffectValues values;
  for (const scene::EffectParameter& parameter : kind.parameters) {
    if (const auto* number = std::get_if<scene::NumberParameter>(&parameter)) {
      values.set(number->key, table.number(*number));
    } else if (const auto* point = std::get_if<scene::PointParameter>(&parameter)) {
      values.set(point->key, parse_point(table, *point));
    } else if (const auto* choice = std::get_if<scene::ChoiceParameter>(&parameter)) {
      values.set(choice->key, table.choice(choice->key, choice->choices));
    }
  }
  return values;
}

scene::Point PartParser::parse_point(CheckedTable& table, const scene::PointParameter& parameter) const {
  if (parameter.preset && table.find(parameter.key) == nullptr) return *parameter.preset;
  return parameter.is_direction ? table.direction(parameter.key, rows_) : table.point(parameter.key, rows_);
}

void PartParser::refuse_pressure_of_nothing(const CheckedTable& object, const toml::node& effects,
                                            const Already& made) {
  const auto presses = [](const scene::RequestedEffect& effect) { return !effect.effect->facts().inputs.pressure; };
  if (std::any_of(made.begin(), made.end(), presses)) return;
  object.fail(effects, "effect '" + made.front().name +
                           "' needs another one that pushes, such as 'surface': its force depends on the pressure");
}

void PartParser::refuse_unrequested_tables(const CheckedTable& part, const toml::table& table,
                                           const Already& effects) const {
  for (const scene::EffectKind& kind : registry_.kinds()) {
    const toml::node* node = table.get(kind.name);
    const bool asked =
        std::any_of(effects.begin(), effects.end(), [&](const auto& effect) { return effect.name == kind.name; });
    if (node != nullptr && !asked) {
      part.fail(*node, "effect '" + std::string(kind.name) + "' has parameters, but is not in effects");
    }
  }
}

}  // namespace forcebound::server
