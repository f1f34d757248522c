#include "forcebound/server/environment/scene_parser.hpp"

#include <algorithm>
#include <array>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/cost.hpp"
#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/server/environment/accuracy_parser.hpp"
#include "forcebound/server/environment/body_parser.hpp"
#include "forcebound/server/environment/part_parser.hpp"
#include "forcebound/server/environment/scene_key.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "forcebound/server/environment/tissue_parser.hpp"
#include "forcebound/server/environment/tool_parser.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

using config::CheckedTable;
using config::Node;

std::uint64_t fnv1a(std::string_view text) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

int parse_degrees_of_freedom(CheckedTable& scene) {
  const Node& node = scene.at("degrees_of_freedom");
  if (const auto* const word = node.as<std::string>(); word != nullptr && *word == "any") {
    return scene::kAnyDegreesOfFreedom;
  }
  const auto* const whole = node.as<std::int64_t>();
  const auto* const number = node.as<double>();
  for (const int axes : {1, 2, 3}) {
    // "3.0" is 3, as elsewhere.
    if ((whole != nullptr && *whole == axes) || (number != nullptr && *number == axes)) return axes;
  }
  scene.refuse("degrees_of_freedom", "1, 2, 3 or \"any\"");
}

class Parser {
 public:
  /// @param measure not empty
  Parser(std::string_view text, std::string file, const scene::Registry& registry, const scene::MeasureCost& measure,
         std::span<const std::string> folders)
      : text_(text), file_(std::move(file)), registry_(registry), measure_(measure), folders_(folders) {}

  std::shared_ptr<const scene::Scene> parse() const { return parse(config::parse_toml(text_, file_), fnv1a(text_)); }

  std::shared_ptr<const scene::Scene> parse_changed(std::span<const SceneChange> changes) const {
    Node whole = without_levels();
    std::string all(text_);
    for (const SceneChange& change : changes) {
      try {
        set_scene_key(whole, change.key, change.value);
      } catch (const std::invalid_argument& error) {
        throw SceneError(file_ + ": " + error.what());
      }
      all += "\n" + change.key + " = " + change.value;
    }
    return parse(whole, fnv1a(all));
  }

 private:
  std::shared_ptr<const scene::Scene> parse(const Node& whole, std::uint64_t hash) const {
    CheckedTable file(whole, file_, "scene file");
    file.allow_files_in(folders_);
    // First: a misspelt table is why another error comes.
    for (const char* const table : {"scene", "accuracy", "tool", "object", "field", "bodies", "body", "tissue"}) {
      (void)file.find(table);
    }
    file.refuse_unknown_keys();
    scene::SceneFacts facts = parse_facts(file.table("scene", "scene"));
    facts.hash = hash;
    parse_tool(file, registry_, facts);
    const double tool_reach_m = facts.tool ? facts.tool->reach_of_points_m() : 0;
    const Eigen::Index axes = facts.degrees_of_freedom == scene::kAnyDegreesOfFreedom ? 1 : facts.degrees_of_freedom;
    scene::SceneParts parts;
    file.each("object", [&](CheckedTable& object, const std::string& name) {
      parts.objects.push_back(parse_part(object, name, true, registry_, axes, tool_reach_m));
    });
    file.each("field", [&](CheckedTable& field, const std::string& name) {
      parts.fields.push_back(parse_part(field, name, false, registry_, axes));
    });
    parts.dynamic_models = parse_bodies(file);
    for (scene::SceneDynamicModel& tissue : parse_tissues(file)) parts.dynamic_models.push_back(std::move(tissue));
    check_tool(file, facts, parts);
    check_dynamic_models(file, facts, parts.dynamic_models);
    refuse_coincident(file, parts.objects);
    for (const scene::EffectKind& kind : registry_.effects()) {
      if (!requested(parts, kind.name)) facts.effects_not_requested.emplace_back(kind.name);
    }
    // Errors of the whole file are reported as such, not as errors of its first level.
    scene::AutoAccuracy accuracy = parse_levels(file, facts);
    return std::make_shared<const scene::Scene>(std::move(facts), std::move(parts), std::move(accuracy));
  }

  scene::AutoAccuracy parse_levels(CheckedTable& file, const scene::SceneFacts& facts) const {
    const Node* const table = file.find("accuracy");
    if (!facts.accuracy_auto) {
      if (table != nullptr) file.fail(*table, "[accuracy] is for scenes with accuracy = \"auto\" in [scene]");
      return {};
    }
    return parse_accuracy(
        file, [&](const std::string& key, const Node& value) { return compile_level(key, value); }, measure_);
  }

  Node without_levels() const {
    Node whole = config::parse_toml(text_, file_);
    auto& tables = *whole.as<Node::Table>();
    tables.erase("accuracy");
    const auto scene = tables.find("scene");
    if (scene == tables.end()) return whole;
    if (auto* const keys = scene->second.as<Node::Table>()) keys->erase("accuracy");
    return whole;
  }

  /// The scene of the file with this value for the key.
  std::shared_ptr<const scene::Scene> compile_level(const std::string& key, const Node& value) const {
    Node whole = without_levels();
    set_scene_key(whole, key, value);
    return parse(whole, fnv1a(std::string(text_) + "\n" + key + " = " + written(value)));
  }

  static scene::SceneFacts parse_facts(CheckedTable scene) {
    const std::vector<config::Parameter> keys = scene_table().keys;
    const config::Values given = scene.given(keys);
    const config::Values values = completed(keys, given);
    scene::SceneFacts facts{.name = values.text("name"),
                            .description = values.text("description"),
                            .degrees_of_freedom = parse_degrees_of_freedom(scene),
                            .shared = values.flag("shared"),
                            .accuracy_auto = values.choice("accuracy") == "auto"};
    if (facts.shared && facts.accuracy_auto) {
      scene.fail(scene.at("accuracy"), "accuracy cannot be \"auto\" in a shared scene, which is one for all");
    }
    if (facts.shared) {
      facts.clients_max = values.whole("clients_max");
    } else if (given.has("clients_max")) {
      scene.fail(scene.at("clients_max"),
                 "clients_max is for shared scenes; any number of clients may feel another one, each alone");
    }
    parse_suggestion(scene, facts);
    scene.refuse_unknown_keys();
    return facts;
  }

  static void check_dynamic_models(CheckedTable& file, const scene::SceneFacts& facts,
                                   const std::vector<scene::SceneDynamicModel>& dynamic_models) {
    if (facts.shared && dynamic_models.empty()) {
      file.fail(file.at("scene"), "shared scenes share bodies and tissue, of which this one has neither");
    }
    for (const scene::SceneDynamicModel& dynamic_model : dynamic_models) {
      if (facts.degrees_of_freedom != 3) {
        file.fail(file.at("scene"), "bodies and tissue need a scene of 3 degrees of freedom");
      }
      const int seats = dynamic_model.dynamic_model->facts().seats_max;
      if (facts.clients_max <= seats) {
        check_states(file, dynamic_model, facts.clients_max);
        continue;
      }
      file.fail(file.at("scene"), "'" + dynamic_model.name + "' has room for " + std::to_string(seats) +
                                      (seats == 1 ? " client" : " clients") + ", got clients_max " +
                                      std::to_string(facts.clients_max));
    }
  }

  /// Checks on loading, not when the first client arrives, that each dynamic model can start with so many clients.
  static void check_states(CheckedTable& file, const scene::SceneDynamicModel& dynamic_model, int clients) {
    try {
      (void)dynamic_model.dynamic_model->make_state(clients);
    } catch (const std::exception& error) {
      file.fail(file.at("scene"),
                "'" + dynamic_model.name + "' for " + std::to_string(clients) + " clients: " + error.what());
    }
  }

  /// Refuses two objects with the same shape in the same place: one surface must belong to one object.
  static void refuse_coincident(const CheckedTable& file, const std::vector<scene::SceneObject>& objects) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (objects[i].shape_kind != objects[j].shape_kind || objects[i].shape_values != objects[j].shape_values)
          continue;
        file.fail("objects '" + objects[j].name + "' and '" + objects[i].name +
                  "' have the same shape in the same place, which would be felt twice: give one object all effects");
      }
    }
  }

  static bool requested(const scene::SceneParts& parts, std::string_view effect) {
    const auto asks = [&](const scene::SceneObject& part) {
      return std::any_of(part.effects.begin(), part.effects.end(),
                         [&](const scene::RequestedEffect& requested) { return requested.name == effect; });
    };
    return std::any_of(parts.objects.begin(), parts.objects.end(), asks) ||
           std::any_of(parts.fields.begin(), parts.fields.end(), asks);
  }

  std::string_view text_;
  std::string file_;
  const scene::Registry& registry_;
  const scene::MeasureCost& measure_;
  std::span<const std::string> folders_;
};

}  // namespace

config::TableDescription scene_table() {
  using config::TextParameter;
  return {
      "`[scene]`",
      "Settings of the whole file.",
      {TextParameter{.key = "name", .meaning = "what clients ask for", .form = TextParameter::Form::name},
       TextParameter{.key = "description", .meaning = "for people"},
       config::OtherParameter{.key = "degrees_of_freedom",
                              .meaning = "of the device that can feel it; one of 6 feels a scene of 3",
                              .accepted = "1, 2, 3 or `\"any\"`"},
       config::FlagParameter{.key = "shared",
                             .meaning = "whether all clients feel the same bodies and tissue, or each its own"},
       config::NumberParameter{.key = "clients_max",
                               .meaning = "at once in a shared scene",
                               .preset = 4,
                               .least = 1,
                               .most = 16,
                               .whole = true},
       config::ChoiceParameter{
           .key = "accuracy",
           .meaning = "whether it is simulated as it stands, or as a level of `[accuracy]` that suits each client",
           .choices = {"fixed", "auto"}},
       TextParameter{
           .key = "suggested_device",
           .meaning = "with which the scene is worth touching, for `forcebound-server --suggest` and the demo",
           .accepted = "a device that ships, of degrees of freedom that the scene accepts",
           .absent = "`\"omni\"`, `\"cartesian-2dof\"` or `\"wall-1dof\"`, by `degrees_of_freedom`"},
       TextParameter{.key = "suggested_hand",
                     .meaning = "the simulated hand on it, as `--operator` of `forcebound-client` takes it: "
                                "`\"stroke:offset_z_m=0.015\"`",
                     .accepted = "`\"press\"`, `\"stroke\"`, `\"trace-circle\"`, `\"trace-sphere\"`, `\"carry\"` or "
                                 "`\"wave\"`, with `:key=value,...`",
                     .absent = "a stroke from above, a press or a wave that was found to touch; see `--explain`"}}};
}

std::shared_ptr<const scene::Scene> parse_scene(std::string_view text, const std::string& file_name,
                                                const scene::Registry& registry, const scene::MeasureCost& measure,
                                                std::span<const std::string> folders) {
  const scene::MeasureCost predicted = [](const std::shared_ptr<const scene::Scene>& scene) {
    return 1e-9 * predicted_cost_ns(*scene);
  };
  return Parser(text, file_name, registry, measure ? measure : predicted, folders).parse();
}

std::shared_ptr<const scene::Scene> parse_changed_scene(std::string_view text, const std::string& file_name,
                                                        std::span<const SceneChange> changes,
                                                        const scene::Registry& registry) {
  return Parser(text, file_name, registry, {}, {}).parse_changed(changes);
}

}  // namespace forcebound::server
