#include "forcebound/server/scene/scene_parser.hpp"

#include <algorithm>

#include "forcebound/server/scene/checked_table.hpp"
#include "forcebound/server/scene/shape_parser.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

std::uint64_t fnv1a(std::string_view text) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

toml::table parse_toml(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw SceneError(file + ":" + std::to_string(error.source().begin.line) + ": " + std::string(error.description()));
  }
}

int parse_degrees_of_freedom(CheckedTable& scene) {
  const toml::node& node = scene.at("degrees_of_freedom");
  if (node.value_exact<std::string>() == "any") return kAnyDegreesOfFreedom;
  const auto number = node.value_exact<std::int64_t>();
  if (!number || *number < 1 || *number > 3) {
    scene.fail(node, "degrees_of_freedom must be 1, 2, 3 or \"any\", got " + as_written(node));
  }
  return static_cast<int>(*number);
}

class Parser {
 public:
  Parser(std::string file, const EffectRegistry& registry) : file_(std::move(file)), registry_(registry) {
    for (const EffectKind& kind : registry.kinds()) known_effects_.emplace_back(kind.name);
  }

  std::shared_ptr<const Scene> parse(std::string_view text) {
    const toml::table whole = parse_toml(text, file_);
    CheckedTable file(whole, file_, "scene file");
    SceneFacts facts = parse_facts(file.table("scene"));
    facts.hash = fnv1a(text);
    rows_ = facts.degrees_of_freedom == kAnyDegreesOfFreedom ? 1 : facts.degrees_of_freedom;

    std::vector<SceneObject> objects;
    if (file.find("object") != nullptr) {
      for (const toml::node& node : file.array("object")) {
        if (!node.is_table()) file.fail(node, "object must be a table, [[object]]");
        SceneObject object = parse_object(*node.as_table());
        if (std::any_of(objects.begin(), objects.end(), [&](const auto& other) { return other.name == object.name; })) {
          file.fail(node, "two objects are named '" + object.name + "'");
        }
        objects.push_back(std::move(object));
      }
    }
    file.refuse_unknown_keys();
    for (const std::string& effect : known_effects_) {
      if (!requested(objects, effect)) facts.effects_not_requested.push_back(effect);
    }
    return std::make_shared<const Scene>(std::move(facts), std::move(objects));
  }

 private:
  SceneFacts parse_facts(const toml::table& table) const {
    CheckedTable scene(table, file_, "scene");
    SceneFacts facts{.name = scene.name("name"),
                     .description = scene.text("description"),
                     .degrees_of_freedom = parse_degrees_of_freedom(scene)};
    scene.refuse_unknown_keys();
    return facts;
  }

  SceneObject parse_object(const toml::table& table) const {
    SceneObject made;
    made.name = CheckedTable(table, file_, "object").name("name");
    CheckedTable object(table, file_, "object '" + made.name + "'");
    (void)object.at("name");
    parse_object_shape(object, made);
    const toml::array& effects = object.array("effects");
    if (effects.empty()) object.fail(effects, "effects must name at least one of: " + text::join(known_effects_));
    for (const toml::node& effect : effects) made.effects.push_back(parse_effect(object, effect, made.effects));
    refuse_unrequested_tables(object, table, made.effects);
    object.refuse_unknown_keys();
    return made;
  }

  void parse_object_shape(CheckedTable& object, SceneObject& made) const {
    CheckedTable shape(object.table("shape"), file_, object.place() + ", shape");
    made.shape = parse_shape(shape, rows_);
    made.shape_text = shape.text("kind") + ", " + shape.numbers_text();
    shape.refuse_unknown_keys();
  }

  RequestedEffect parse_effect(CheckedTable& object, const toml::node& wanted,
                               const std::vector<RequestedEffect>& already) const {
    const auto name = wanted.value_exact<std::string>();
    if (!name) object.fail(wanted, "effects must be names, got " + as_written(wanted));
    const EffectKind* kind = registry_.find(*name);
    if (kind == nullptr) {
      object.fail(wanted, "unknown effect '" + *name + "'" + text::suggestion(*name, known_effects_));
    }
    if (std::any_of(already.begin(), already.end(), [&](const auto& effect) { return effect.name == *name; })) {
      object.fail(wanted, "effect '" + *name + "' is asked for twice");
    }
    // An effect whose parameters all have presets needs no table.
    static const toml::table kNoParameters;
    const bool has_table = object.find(*name) != nullptr;
    const bool needs_table = std::any_of(kind->parameters.begin(), kind->parameters.end(),
                                         [](const EffectParameter& parameter) { return !parameter.preset; });
    const toml::table& table = has_table || needs_table ? object.table(*name) : kNoParameters;
    CheckedTable parameters(table, file_, object.place() + ", effect '" + *name + "'");
    std::vector<double> values;
    for (const EffectParameter& parameter : kind->parameters) values.push_back(parameters.number(parameter));
    parameters.refuse_unknown_keys();
    return {*name, std::string(kind->law), parameters.numbers_text(), kind->make(values)};
  }

  void refuse_unrequested_tables(const CheckedTable& object, const toml::table& table,
                                 const std::vector<RequestedEffect>& effects) const {
    for (const std::string& name : known_effects_) {
      const toml::node* node = table.get(name);
      const bool asked =
          std::any_of(effects.begin(), effects.end(), [&](const auto& effect) { return effect.name == name; });
      if (node != nullptr && !asked) {
        object.fail(*node, "effect '" + name + "' has parameters, but is not in effects");
      }
    }
  }

  static bool requested(const std::vector<SceneObject>& objects, const std::string& effect) {
    return std::any_of(objects.begin(), objects.end(), [&](const SceneObject& object) {
      return std::any_of(object.effects.begin(), object.effects.end(),
                         [&](const RequestedEffect& requested) { return requested.name == effect; });
    });
  }

  std::string file_;
  const EffectRegistry& registry_;
  std::vector<std::string> known_effects_;
  Eigen::Index rows_ = 0;
};

}  // namespace

std::shared_ptr<const Scene> parse_scene(std::string_view text, const std::string& file_name,
                                         const EffectRegistry& registry) {
  return Parser(file_name, registry).parse(text);
}

}  // namespace forcebound::server
