#include "forcebound/server/environment/accuracy_parser.hpp"

#include "forcebound/scene/scene.hpp"

namespace forcebound::server {
namespace {

scene::AccuracyLevel parse_level(CheckedTable& level, const std::string& key, const CompileLevel& compile,
                                 const scene::MeasureCost& measure) {
  const toml::node& value = level.at("value");
  scene::AccuracyLevel made{.value = as_written(value), .model_error = level.number(kModelError)};
  level.refuse_unknown_keys();
  try {
    made.scene = compile(key, value);
  } catch (const std::exception& error) {
    level.fail(value, "with " + key + " = " + made.value + ": " + error.what());
  }
  made.step_s = measure(made.scene);
  return made;
}

}  // namespace

scene::AutoAccuracy parse_accuracy(CheckedTable& file, const CompileLevel& compile, const scene::MeasureCost& measure) {
  CheckedTable table(file.table("accuracy"), file.file(), "accuracy");
  scene::AutoAccuracy accuracy{.key = table.text("key"), .change_per_s = table.number(kChangePerSecond)};
  if (accuracy.key == "scene" || accuracy.key.starts_with("scene.") || accuracy.key.starts_with("accuracy")) {
    table.fail(table.at("key"), "key must be one of an object, a field, bodies or tissue, got '" + accuracy.key + "'");
  }
  const toml::array& levels = table.array("levels");
  if (levels.size() < 2) table.fail(levels, "levels must be two or more, got " + std::to_string(levels.size()));
  for (const toml::node& node : levels) {
    const toml::table* const level = node.as_table();
    if (level == nullptr)
      table.fail(node, "levels must be { value = ..., model_error = ... }, got " + as_written(node));
    CheckedTable checked(*level, file.file(), "accuracy, level " + std::to_string(accuracy.levels.size() + 1));
    accuracy.levels.push_back(parse_level(checked, accuracy.key, compile, measure));
  }
  table.refuse_unknown_keys();
  return accuracy;
}

}  // namespace forcebound::server
