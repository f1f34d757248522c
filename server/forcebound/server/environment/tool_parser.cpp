#include "forcebound/server/environment/tool_parser.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/server/environment/part_parser.hpp"

namespace forcebound::server {
namespace {

using config::CheckedTable;

constexpr int kSpace = 3;

struct ToolShape {
  std::vector<scene::ToolPoint> points;
  std::vector<scene::ToolPart> parts;
};

void parse_tool_part(CheckedTable& part, const std::string& name, const scene::Registry& registry, double spacing_m,
                     ToolShape& shape) {
  scene::SceneObject made{.name = name};
  (void)part.given(tool_part_table().keys, kSpace);
  parse_shape(part, registry, made, kSpace);
  part.refuse_unknown_keys();
  part.built_at(part.at("shape"), [&] {
    std::vector<scene::ToolPoint> points =
        points_of_part(made.shape_kind, made.shape_values, made.shape->geometry(), spacing_m);
    // Told of the part that is at fault.
    (void)scene::Tool(points);
    shape.points.insert(shape.points.end(), points.begin(), points.end());
    if (const auto convex = scene::convex_part(made.shape_kind, made.shape_values)) shape.parts.push_back(*convex);
  });
}

}  // namespace

config::TableDescription tool_table() {
  return {"`[tool]`",
          "The rigid tool in the hand, in the axes of a handle that tells its orientation. It touches objects with the "
          "points of its parts, without a part with its tip; fields act at the tip.",
          {config::OtherParameter{.key = "tip_m",
                                  .meaning = "from the grip to the tip",
                                  .accepted = "`[x, y, z]`, each from -0.5 to 0.5",
                                  .absent = "`[0, 0, 0]`"},
           config::positive_number("spacing_m", "of the points of its surface, and of the balls in a capsule",
                                   scene::kToolReachMost_m, 2e-3),
           config::ChoiceParameter{.key = "contact",
                                   .meaning = "`constraint`: it stays outside of what is solid as a body, as stiff as "
                                              "one point, and parts but meshes meet boxes, balls, rods and planes "
                                              "between their points too; `penalty`: each point pushes by its own depth",
                                   .choices = {"constraint", "penalty"}}}};
}

config::TableDescription tool_part_table() {
  return {"`[[tool.part]]`",
          "All parts have at most 10,000 points, within 0.5 m of the tip.",
          {config::name_of_part(),
           config::OtherParameter{.key = "shape",
                                  .meaning = "a sphere, capsule, box, cylinder or closed mesh, from the tip"}}};
}

void parse_tool(CheckedTable& file, const scene::Registry& registry, scene::SceneFacts& facts) {
  if (file.find("tool") == nullptr) return;
  CheckedTable tool = file.table("tool", "tool");
  if (facts.degrees_of_freedom != kSpace) tool.fail("a tool needs a scene with degrees_of_freedom = 3");
  const config::Values given = config::completed(tool_table().keys, tool.given(tool_table().keys));
  const double spacing_m = given.number("spacing_m");
  ToolShape shape;
  tool.each("part", [&](CheckedTable& part, const std::string& name) {
    parse_tool_part(part, name, registry, spacing_m, shape);
  });
  if (shape.points.empty()) (void)tool.at("tip_m", "the tip of a tool without [[tool.part]]");
  constexpr double kLongest_m = 0.5;
  facts.tool_m = tool.vector({.key = "tip_m", .preset = 0, .least = -kLongest_m, .most = kLongest_m}, kSpace);
  tool.refuse_unknown_keys();
  if (shape.points.empty()) return;
  const auto contact =
      given.text("contact") == "penalty" ? scene::ToolContact::penalty : scene::ToolContact::constraint;
  tool.built_at(tool.node(), [&] {
    facts.tool = std::make_shared<const scene::Tool>(std::move(shape.points), contact, std::move(shape.parts));
  });
}

void check_tool(CheckedTable& file, const scene::SceneFacts& facts, const scene::SceneParts& parts) {
  if (!facts.tool) return;
  if (!parts.dynamic_models.empty()) {
    file.fail(file.at("tool"), "a tool with parts touches objects alone, got '" + parts.dynamic_models.front().name +
                                   "': leave out tissue and bodies, or [[tool.part]]");
  }
  for (const scene::SceneObject& object : parts.objects) {
    const auto refused = std::ranges::find_if(object.effects, [](const scene::RequestedEffect& requested) {
      return requested.name == "texture" || requested.effect->facts().fades_without_server;
    });
    if (refused == object.effects.end()) continue;
    file.fail(file.at("tool"), "a tool with parts feels no " + refused->name + ", got that of object '" + object.name +
                                   "': leave it out, or [[tool.part]]");
  }
}

}  // namespace forcebound::server
