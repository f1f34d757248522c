#include "forcebound/server/environment/schema.hpp"

#include "forcebound/server/environment/accuracy_parser.hpp"
#include "forcebound/server/environment/body_parser.hpp"
#include "forcebound/server/environment/part_parser.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/environment/tissue_parser.hpp"

namespace forcebound::server {
namespace {

/// A cell of a table ends at a bar, unless that is escaped.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? "\\|" : std::string(1, c);
  return escaped;
}

std::string rows_of(const std::vector<config::Parameter>& keys) {
  std::string text = "| key | meaning | value | if left out |\n| --- | --- | --- | --- |\n";
  for (const config::Parameter& key : keys) {
    const std::string preset = config::preset_text(key);
    text += "| `" + std::string(key_of(key)) + "` | " + cell(std::string(config::meaning_of(key))) + " | " +
            cell(config::accepted_text(key)) + " | " + (preset.empty() ? "*must be given*" : cell(preset)) + " |\n";
  }
  return text + "\n";
}

std::string sections(const std::string& level, const std::vector<config::TableDescription>& tables) {
  std::string text;
  for (const config::TableDescription& table : tables) {
    text += level + " " + table.title + "\n\n" + table.text + "\n\n" + (table.keys.empty() ? "" : rows_of(table.keys));
  }
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
         "* Paths of files that a scene names are relative to its own folder, unless they are absolute.\n"
         "\n";
}

std::string place_text(scene::EffectPlace place) { return place == scene::EffectPlace::surface ? "surface" : "space"; }

std::string sentence(std::string_view text) {
  std::string made(text);
  if (!made.empty() && made[0] >= 'a' && made[0] <= 'z') made[0] = static_cast<char>(made[0] - 'a' + 'A');
  return made + ".";
}

std::string overview(const scene::Registry& registry) {
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
  for (const scene::EffectKind& kind : registry.effects()) {
    const std::string name(kind.name);
    text.append("| [`").append(name).append("`](#").append(name).append(") | ");
    text.append(cell(std::string(kind.purpose))).append(" | ").append(place_text(kind.place)).append(" |\n");
  }
  return text + "\n";
}

std::vector<config::TableDescription> effect_tables(const scene::Registry& registry) {
  std::vector<config::TableDescription> tables;
  for (const scene::EffectKind& kind : registry.effects()) {
    tables.push_back({std::string(kind.name),
                      sentence(kind.purpose) + " Of " + place_text(kind.place) + ".\n\n    " + std::string(kind.law),
                      kind.parameters});
  }
  return tables;
}

std::vector<config::TableDescription> shape_tables(const scene::Registry& registry) {
  std::vector<config::TableDescription> tables;
  for (const scene::ShapeKind& kind : registry.shapes()) {
    tables.push_back({std::string(kind.name), std::string(kind.description), kind.parameters});
  }
  return tables;
}

constexpr const char* kTimeOfDynamicModels = R"(
Where each client has its own, time goes by the clock of its device: a motion that comes late is answered as if it
had come in time. In a shared scene there is one time, the server's, and a motion counts when it arrives. Between two
motions a device is held where it was, and the damper of a coupling believes its velocity for 10 ms more. Who holds
still, or is not heard of, holds still what it touches. When the last client leaves, the scene begins anew for the
next one.

)";

}  // namespace

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

std::vector<config::TableDescription> part_tables() {
  return {scene_table(), accuracy_table(), accuracy_level_table(), field_table(), object_table()};
}

std::vector<config::TableDescription> dynamic_model_tables() {
  std::vector<config::TableDescription> tables = body_tables();
  for (config::TableDescription& table : tissue_tables()) tables.push_back(std::move(table));
  return tables;
}

std::string schema(const scene::Registry& registry) {
  std::string text = introduction() + sections("##", part_tables());
  text += "### Shapes\n\nThe `shape` of an object has `kind = \"NAME\"`, and the keys of that kind.\n\n";
  text += sections("####", shape_tables(registry));
  text +=
      "## Bodies and tissue\n\nParts that move or deform by themselves. They need a scene of 3 degrees of freedom.\n";
  text += kTimeOfDynamicModels;
  text += sections("###", dynamic_model_tables());
  text += overview(registry) + sections("###", effect_tables(registry));
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace forcebound::server
