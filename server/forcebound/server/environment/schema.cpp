#include "forcebound/server/environment/schema.hpp"

#include <cmath>
#include <limits>

#include "forcebound/server/environment/accuracy_parser.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string quoted(std::string_view word) { return "`\"" + std::string(word) + "\"`"; }

/// A preset outside of the range means that the key may be left out; its meaning says what holds then.
std::string preset_text(const scene::NumberParameter& number) {
  if (!number.preset) return "";
  const double preset = *number.preset;
  if (preset == kInfinity) return "no limit";
  const bool above = number.least_excluded ? preset > number.least : preset >= number.least;
  return above ? text::to_text(preset) : "not given";
}

std::string preset_text(const scene::PointParameter& point) {
  if (!point.preset) return "";
  if (point.preset->minCoeff() == kInfinity) return "no limit";
  std::string text;
  for (const double value : *point.preset) text += (text.empty() ? "" : ", ") + text::to_text(value);
  return "[" + text + "]";
}

SchemaKey words_for(const scene::NumberParameter& number) {
  return {std::string(number.key), std::string(number.meaning), scene::range_text(number), preset_text(number)};
}

SchemaKey words_for(const scene::PointParameter& point) {
  return {std::string(point.key), std::string(point.meaning), point.is_direction ? "a direction" : "a point",
          preset_text(point)};
}

SchemaKey words_for(const scene::ChoiceParameter& choice) {
  std::vector<std::string> words;
  words.reserve(choice.choices.size());
  for (const std::string_view word : choice.choices) words.push_back(quoted(word));
  return {std::string(choice.key), std::string(choice.meaning), text::join(words), words.front()};
}

/// A cell of a table ends at a bar, unless that is escaped.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? "\\|" : std::string(1, c);
  return escaped;
}

std::string rows_of(const std::vector<SchemaKey>& keys) {
  std::string text = "| key | meaning | value | if left out |\n| --- | --- | --- | --- |\n";
  for (const SchemaKey& key : keys) {
    text += "| `" + key.key + "` | " + cell(key.meaning) + " | " + cell(key.values) + " | " +
            (key.preset.empty() ? "*must be given*" : cell(key.preset)) + " |\n";
  }
  return text + "\n";
}

std::string section(const std::string& level, const SchemaTable& table) {
  return level + " " + table.title + "\n\n" + table.text + "\n\n" + (table.keys.empty() ? "" : rows_of(table.keys));
}

std::string sections(const std::string& level, const std::vector<SchemaTable>& tables) {
  std::string text;
  for (const SchemaTable& table : tables) text += section(level, table);
  return text;
}

std::string introduction() {
  return "# Scene files\n"
         "\n"
         "A scene says which effects each object has; the server simulates exactly these. This page has all that a "
         "scene file may\n"
         "contain. The program itself writes it: `forcebound-server --schema > server/scenes/README.md`.\n"
         "\n"
         "```toml\n" +
         schema_example() +
         "```\n"
         "\n"
         "Save it as `shelf.toml`; `forcebound-server --scene shelf.toml --explain` tells what it simulates and what "
         "not, and\n"
         "`forcebound-server --scene shelf.toml` serves it. The files beside this page are examples, one for each "
         "effect and more.\n"
         "\n"
         "* Keys carry their units: SI throughout.\n"
         "* A point has as many numbers as the scene has degrees of freedom; a scene for `\"any\"` device lies on its "
         "first axis, so\n"
         "  it has one. Vectors are written like points. A direction may have any length but zero.\n"
         "* Numbers are finite. A key that is unknown, missing or out of range is an error with file, line and place, "
         "and the\n"
         "  nearest known key.\n"
         "* Files that a scene names lie beside it.\n"
         "\n";
}

std::string place_text(scene::EffectPlace place) { return place == scene::EffectPlace::surface ? "surface" : "space"; }

std::string sentence(std::string_view text) {
  std::string made(text);
  if (!made.empty() && made[0] >= 'a' && made[0] <= 'z') made[0] = static_cast<char>(made[0] - 'a' + 'A');
  return made + ".";
}

std::string overview(const scene::EffectRegistry& registry) {
  std::string text =
      "## Effects\n"
      "\n"
      "`effects = [\"NAME\", ...]` asks for them, and a table of the same name has their parameters; where all of them "
      "may be left\n"
      "out, so may the table. An effect of a *surface* belongs to an `[[object]]`. One of *space* fills a `[[field]]`, "
      "or an\n"
      "object's inside. In the laws, x is the device's position, v its velocity and t the time; forces act on the "
      "device.\n"
      "\n"
      "| effect | what a hand feels | place |\n"
      "| --- | --- | --- |\n";
  for (const scene::EffectKind& kind : registry.kinds()) {
    const std::string name(kind.name);
    text.append("| [`").append(name).append("`](#").append(name).append(") | ");
    text.append(cell(std::string(kind.purpose))).append(" | ").append(place_text(kind.place)).append(" |\n");
  }
  return text + "\n";
}

SchemaTable table_of(const scene::EffectKind& kind) {
  SchemaTable table{
      .title = std::string(kind.name),
      .text = sentence(kind.purpose) + " Of " + place_text(kind.place) + ".\n\n    " + std::string(kind.law),
      .keys = {}};
  for (const scene::EffectParameter& parameter : kind.parameters) table.keys.push_back(described(parameter));
  return table;
}

std::vector<SchemaTable> effect_tables(const scene::EffectRegistry& registry) {
  std::vector<SchemaTable> tables;
  for (const scene::EffectKind& kind : registry.kinds()) tables.push_back(table_of(kind));
  return tables;
}

}  // namespace

SchemaKey described(const scene::EffectParameter& parameter) {
  return std::visit([](const auto& any) { return words_for(any); }, parameter);
}

constexpr const char* kTimeOfDynamicModels = R"(
Where each client has its own, time goes by the clock of its device: a motion that comes late is answered as if it
had come in time. In a shared scene there is one time, the server's, and a motion counts when it arrives. Between two
motions a device is held where it was, and the damper of a coupling believes its velocity for 10 ms more. Who holds
still, or is not heard of, holds still what it touches. When the last client leaves, the scene begins anew for the
next one.

)";

std::vector<SchemaTable> part_tables() {
  const SchemaKey name{"name", "for errors, logs and `--explain`", "1 to 64 printable characters"};
  const SchemaKey effects{"effects", "see [Effects](#effects)", "a list of names"};
  return {
      {"`[scene]`",
       "What holds for the whole file.",
       {{"name", "what clients ask for", "1 to 64 printable characters"},
        {"description", "for people", "text"},
        {"degrees_of_freedom", "of the device that can feel it; one of 6 feels a scene of 3", "1, 2, 3 or `\"any\"`"},
        {"shared", "whether all clients feel the same bodies and tissue, or each its own", "`true` or `false`",
         "`false`"},
        described(kClientsMax),
        {"accuracy", "whether it is simulated as it stands, or as a level of `[accuracy]` that suits each client",
         "`\"fixed\"` or `\"auto\"`", "`\"fixed\"`"},
        {"suggested_device", "with which the scene is worth touching, for `forcebound-server --suggest` and the demo",
         "a device that ships, of degrees of freedom that the scene accepts",
         "`\"omni\"`, `\"cartesian-2dof\"` or `\"wall-1dof\"`, by `degrees_of_freedom`"},
        {"suggested_hand",
         "the simulated hand on it, as `--operator` of `forcebound-client` takes it: `\"stroke:offset_z_m=0.015\"`",
         "`\"press\"`, `\"stroke\"`, `\"trace-circle\"`, `\"trace-sphere\"` or `\"wave\"`, with `:key=value,...`",
         "a stroke from above, a press or a wave that was found to touch; see `--explain`"}}},
      {"`[accuracy]`",
       "With `accuracy = \"auto\"`: what the scene may give up to be in time. A client says how far away it is, the "
       "server measures what each level takes on its machine, and picks the one whose force is least wrong at the "
       "device, late ones counted as wrong. `forcebound-lab accuracy --levels FILE` measures these numbers.",
       {{"key",
         "what the levels differ in: `tissue.pad.shape.cells` is the key `cells` of the `shape` of the `[[tissue]]` "
         "named `pad`",
         "a key of this file"},
        described(kChangePerSecond),
        {"levels", "from coarse to fine", "two or more tables, see the next"}}},
      {"A level of `[accuracy]`",
       "What is in the file for the key counts where no client is known, as for `--explain`.",
       {{"value", "for the key", "what the key may have"}, described(kModelError)}},
      {"`[[field]]`", "What fills space: only effects of space, and no shape.", {name, effects}},
      {"`[[object]]`",
       "What has a surface. No two have the same shape in the same place.",
       {name, effects, {"shape", "a table whose `kind` is one of the [shapes](#shapes)", "a table"}}}};
}

std::string schema_example() {
  return "[scene]\n"
         "name = \"shelf\"\n"
         "description = \"A rough shelf at z = 0, under honey.\"\n"
         "degrees_of_freedom = 3\n"
         "\n"
         "[[object]]\n"
         "name = \"shelf\"\n"
         "shape = { kind = \"half_space\", through_m = [0, 0, 0], normal = [0, 0, 1] }\n"
         "effects = [\"surface\", \"friction\"]\n"
         "surface = { stiffness_N_per_m = 800, damping_N_s_per_m = 1 }\n"
         "friction = { static_coefficient = 0.4 }\n"
         "\n"
         "[[field]]\n"
         "name = \"honey\"\n"
         "effects = [\"viscosity\"]\n"
         "viscosity = { damping_N_s_per_m = 2 }\n";
}

std::string schema(const scene::EffectRegistry& registry) {
  std::string text = introduction() + sections("##", part_tables());
  text += "### Shapes\n\nThe `shape` of an object has `kind = \"NAME\"`, and the keys of that kind.\n\n";
  text += sections("####", shape_tables());
  text += "## Bodies and tissue\n\nWhat moves or deforms by itself. It needs a scene of 3 degrees of freedom.\n";
  text += kTimeOfDynamicModels;
  text += sections("###", dynamic_model_tables());
  text += overview(registry) + sections("###", effect_tables(registry));
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace forcebound::server
