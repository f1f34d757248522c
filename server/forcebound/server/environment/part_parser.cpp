#include "forcebound/server/environment/part_parser.hpp"

#include <algorithm>
#include <variant>

#include "forcebound/server/environment/mesh_file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

config::OtherParameter effects_of_part() {
  return {.key = "effects", .meaning = "see [Effects](#effects)", .accepted = "a list of names"};
}

void parse_effect(config::CheckedTable& part, const config::Node& wanted, const scene::EffectKind& kind,
                  scene::SceneObject& made, Eigen::Index axes) {
  const std::string name(kind.name);
  // An effect whose parameters may all be left out needs no table; of another one the missing key is reported.
  const config::Node no_table{.line = wanted.line};
  const std::string place = part.place() + ", effect '" + name + "'";
  config::CheckedTable table =
      part.find(name) != nullptr ? part.table(name, place) : config::CheckedTable(no_table, part.file(), place);
  const config::Values given = table.given(kind.parameters, axes);
  table.refuse_unknown_keys();
  table.built_at(table.node(), [&] { scene::add_effect(made, kind, given, axes); });
}

void refuse_unrequested_tables(const config::CheckedTable& part, const scene::SceneObject& made,
                               const scene::Registry& registry) {
  for (const scene::EffectKind& kind : registry.effects()) {
    const config::Node* const table = part.node().find(kind.name);
    if (table == nullptr) continue;
    if (std::ranges::find(made.effects, kind.name, &scene::RequestedEffect::name) != made.effects.end()) continue;
    part.fail(*table, "effect '" + std::string(kind.name) + "' has parameters, but is not in effects");
  }
}

}  // namespace

config::TableDescription field_table() {
  return {"`[[field]]`",
          "A part that fills space: it has only effects of space, and no shape.",
          {config::name_of_part(), effects_of_part()}};
}

config::TableDescription object_table() {
  return {"`[[object]]`",
          "A part with a surface. No two objects have the same shape in the same place.",
          {config::name_of_part(), effects_of_part(),
           config::OtherParameter{.key = "shape", .meaning = "a table whose `kind` is one of the [shapes](#shapes)"}}};
}

void parse_shape(config::CheckedTable& part, const scene::Registry& registry, scene::SceneObject& made,
                 Eigen::Index axes) {
  config::CheckedTable shape = part.table("shape");
  const std::string kinds = text::join(scene::shape_names(registry));
  const std::string name = shape.text(config::TextParameter{.key = "kind", .accepted = kinds});
  const scene::ShapeKind& kind = shape.built_at(
      shape.at("kind"), [&]() -> const scene::ShapeKind& { return scene::shape_kind(registry, name, axes); });
  const config::Values given = shape.given(kind.parameters, axes);
  shape.refuse_unknown_keys();
  for (const config::Parameter& parameter : kind.parameters) {
    const auto* const text = std::get_if<config::TextParameter>(&parameter);
    if (text == nullptr || text->form != config::TextParameter::Form::file || !given.has(text->key)) continue;
    (void)shape.path_at(text->key, given.text(text->key));
  }
  const config::Node* const source = shape.node().find(kind.source);
  shape.built_at(source != nullptr ? *source : shape.node(), [&] {
    scene::set_shape(made, kind, given, axes, part.folder(), triangles_of(kind, given, part.folder()));
  });
}

scene::SceneObject parse_part(config::CheckedTable& part, const std::string& name, bool is_object,
                              const scene::Registry& registry, Eigen::Index axes, double tool_reach_m) {
  scene::SceneObject made{.name = name, .tool_reach_m = tool_reach_m};
  // The values are read below, with their places; here the keys become known, and a missing one is told.
  (void)part.given((is_object ? object_table() : field_table()).keys, axes);
  const config::Node::List& effects = part.list("effects");
  const config::Node& list = part.at("effects");
  if (effects.empty()) {
    part.fail(list, "effects must name at least one of: " + text::join(scene::effect_names(registry, is_object)));
  }
  for (const config::Node& wanted : effects) {
    const auto* const effect = wanted.as<std::string>();
    if (effect == nullptr) part.fail(wanted, "effects must be names, got " + written(wanted));
    const scene::EffectKind& kind = part.built_at(
        wanted, [&]() -> const scene::EffectKind& { return scene::effect_kind(registry, *effect, is_object, made); });
    parse_effect(part, wanted, kind, made, axes);
  }
  if (is_object) {
    part.built_at(list, [&] { scene::check_effects(made); });
    parse_shape(part, registry, made, axes);
  }
  refuse_unrequested_tables(part, made, registry);
  part.refuse_unknown_keys();
  return made;
}

}  // namespace forcebound::server
