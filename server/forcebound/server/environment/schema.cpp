#include "forcebound/server/environment/schema.hpp"

#include "forcebound/server/environment/accuracy_parser.hpp"
#include "forcebound/server/environment/body_parser.hpp"
#include "forcebound/server/environment/part_parser.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/environment/tissue_parser.hpp"
#include "forcebound/server/environment/tool_parser.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

std::string line_of(const config::Parameter& key) {
  const std::string preset = config::preset_text(key);
  return "* `" + std::string(key_of(key)) + "` (" + config::accepted_text(key) +
         (preset.empty() ? "" : "; default " + preset) + "): " + std::string(config::meaning_of(key)) + "\n";
}

std::string lines_of(const std::vector<config::Parameter>& keys) {
  std::string text;
  for (const config::Parameter& key : keys) text += line_of(key);
  return text;
}

/// The lines of a table's keys. Those that one of the tables before has in the same words are named, if two or more.
std::string list_of(const config::TableDescription& table, const std::vector<config::TableDescription>& before) {
  for (const config::TableDescription& other : before) {
    const std::string known = lines_of(other.keys);
    std::vector<std::string> shared;
    std::string own;
    for (const config::Parameter& key : table.keys) {
      const std::string line = line_of(key);
      if (known.find(line) == std::string::npos) {
        own += line;
      } else {
        shared.push_back("`" + std::string(key_of(key)) + "`");
      }
    }
    if (shared.size() >= 2) return "* " + text::join(shared) + ": as of " + other.title + "\n" + own + "\n";
  }
  return lines_of(table.keys) + "\n";
}

/// @param before the tables that the page has so far; these are added
std::string sections(const std::string& level, const std::vector<config::TableDescription>& tables,
                     std::vector<config::TableDescription>& before) {
  std::string text;
  for (const config::TableDescription& table : tables) {
    text += level + " " + table.title + "\n\n" + table.text + "\n\n";
    if (!table.keys.empty()) text += list_of(table, before);
    before.push_back(table);
  }
  return text;
}

std::string introduction() {
  return "# Scene files\n"
         "\n"
         "All that a scene file may contain, written by `forcebound-server --schema > server/scenes/README.md`. The "
         "server\n"
         "simulates exactly the effects that it names.\n"
         "\n"
         "```toml\n" +
         schema_example() +
         "```\n"
         "\n"
         "Saved as `shelf.toml`: `forcebound-server --scene shelf.toml --explain` says what it simulates and what not, "
         "and\n"
         "`forcebound-server --scene shelf.toml` serves it. The files beside this page are examples, one for each "
         "effect and more.\n"
         "\n"
         "* Keys carry their units: SI throughout. A key without a default must be given.\n"
         "* A point or vector has as many numbers as the scene has degrees of freedom; a scene for `\"any\"` device "
         "lies "
         "on its\n"
         "  first axis, so it has one. A direction may have any length but zero.\n"
         "* Numbers are finite. A key that is unknown, missing or out of range is an error with file, line and place, "
         "and the\n"
         "  nearest known key.\n"
         "* Paths of files are relative to the scene's own folder, unless they are absolute.\n"
         "\n";
}

std::string place_text(scene::EffectPlace place) { return place == scene::EffectPlace::surface ? "surface" : "space"; }

std::string sentence(std::string_view text) {
  std::string made(text);
  if (!made.empty() && made[0] >= 'a' && made[0] <= 'z') made[0] = static_cast<char>(made[0] - 'a' + 'A');
  return made + ".";
}

constexpr const char* kEffects = R"(## Effects

`effects = ["NAME", ...]` asks for them, and a table of the same name has their parameters; where all of them have
defaults, it may be left out. An effect of a *surface* belongs to an `[[object]]`. One of *space* fills a `[[field]]`,
or an object's inside. In the laws, x is the device's position, v its velocity and t the time; forces act on the device.

)";

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
Where each client has its own, time goes by the clock of its device: a late motion is answered as if it had come in
time. In a shared scene there is one time, the server's, and a motion counts when it arrives. Between two motions a
device is held where it was, and the damper of a coupling believes its velocity for 10 ms more. When the last client
leaves, the scene begins anew for the next one.

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
  return {scene_table(),     accuracy_table(), accuracy_level_table(), tool_table(),
          tool_part_table(), field_table(),    object_table()};
}

std::vector<config::TableDescription> dynamic_model_tables() {
  std::vector<config::TableDescription> tables = body_tables();
  for (config::TableDescription& table : tissue_tables()) tables.push_back(std::move(table));
  return tables;
}

std::string schema(const scene::Registry& registry) {
  std::vector<config::TableDescription> before;
  std::string text = introduction() + sections("##", part_tables(), before);
  text += "### Shapes\n\nThe `shape` of an object has `kind = \"NAME\"`, and the keys of that kind.\n\n";
  text += sections("####", shape_tables(registry), before);
  text +=
      "## Bodies and tissue\n\nParts that move or deform by themselves. They need a scene of 3 degrees of freedom.\n";
  text += kTimeOfDynamicModels;
  text += sections("###", dynamic_model_tables(), before);
  text += kEffects + sections("###", effect_tables(registry), before);
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace forcebound::server
