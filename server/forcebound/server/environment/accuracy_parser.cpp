#include "forcebound/server/environment/accuracy_parser.hpp"

#include "forcebound/scene/rendering.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::server {
namespace {

using config::NumberParameter;
using config::OtherParameter;
using config::positive_number;

scene::AccuracyLevel parse_level(config::CheckedTable& level, const std::string& key, const CompileLevel& compile,
                                 const scene::MeasureCost& measure) {
  const config::Values values = level.all(accuracy_level_table().keys);
  const config::Node& value = level.at("value");
  scene::AccuracyLevel made{.value = written(value), .model_error = values.number("model_error")};
  try {
    made.scene = compile(key, value);
  } catch (const std::exception& error) {
    level.fail(value, "with " + key + " = " + made.value + ": " + error.what());
  }
  made.step_s = measure(made.scene);
  return made;
}

/// What a client that renders locally is left with of the change: nothing where all runs there, all where a part is
/// held.
double change_locally_per_s(const scene::Scene& scene, double change_per_s, double extrapolation_per_s) {
  const scene::Rendering least = scene.least_rendering();
  if (least == scene::Rendering::held) return change_per_s;
  return least == scene::Rendering::modelled ? extrapolation_per_s : 0;
}

}  // namespace

config::TableDescription accuracy_table() {
  return {
      "`[accuracy]`",
      "With `accuracy = \"auto\"`: what the scene may give up to be in time. The server picks the level whose force "
      "is least wrong at a client's device, late ones counted as wrong. `forcebound-lab accuracy --levels FILE` "
      "measures these numbers.",
      {config::TextParameter{.key = "key",
                             .meaning = "what the levels differ in: `tissue.pad.shape.cells` is the key `cells` of "
                                        "the `shape` of the `[[tissue]]` named `pad`",
                             .accepted = "a key of this file"},
       positive_number("change_per_s",
                       "how fast the force changes: the RMS of its rate over its own, for the motion "
                       "the scene is made for",
                       1e4),
       NumberParameter{.key = "extrapolation_per_s",
                       .meaning = "the same of what a local model misses, for clients that render locally; "
                                  "`accuracy --rendering local` measures it",
                       .least = 0,
                       .most = 1e4,
                       .absent = "that of `change_per_s`"},
       OtherParameter{
           .key = "levels", .meaning = "from coarse to fine", .accepted = "two or more tables, see the next"}}};
}

config::TableDescription accuracy_level_table() {
  return {"A level of `[accuracy]`",
          "Without a client, as for `--explain`, the value in the file applies.",
          {OtherParameter{.key = "value", .meaning = "for the key", .accepted = "what the key may have"},
           NumberParameter{.key = "model_error",
                           .meaning = "RMS of the force's error at the same states over RMS of the force",
                           .least = 0,
                           .most = 100}}};
}

scene::AutoAccuracy parse_accuracy(config::CheckedTable& file, const CompileLevel& compile,
                                   const scene::MeasureCost& measure) {
  config::CheckedTable table = file.table("accuracy", "accuracy");
  const config::Values values = table.all(accuracy_table().keys);
  scene::AutoAccuracy accuracy{.key = values.text("key"), .change_per_s = values.number("change_per_s")};
  if (accuracy.key == "scene" || accuracy.key.starts_with("scene.") || accuracy.key.starts_with("accuracy")) {
    table.fail(table.at("key"), "key must be one of an object, a field, bodies or tissue, got '" + accuracy.key + "'");
  }
  const config::Node::List& levels = table.list("levels");
  if (levels.size() < 2) {
    table.fail(table.at("levels"), "levels must be two or more, got " + std::to_string(levels.size()));
  }
  for (const config::Node& level : levels) {
    if (level.as<config::Node::Table>() == nullptr) {
      table.fail(level, "levels must be { value = ..., model_error = ... }, got " + written(level));
    }
    config::CheckedTable checked(level, file.file(), "accuracy, level " + std::to_string(accuracy.levels.size() + 1));
    accuracy.levels.push_back(parse_level(checked, accuracy.key, compile, measure));
  }
  // The levels differ in a value, not in their parts.
  accuracy.change_locally_per_s = change_locally_per_s(
      *accuracy.levels.front().scene, accuracy.change_per_s,
      values.has("extrapolation_per_s") ? values.number("extrapolation_per_s") : accuracy.change_per_s);
  return accuracy;
}

}  // namespace forcebound::server
