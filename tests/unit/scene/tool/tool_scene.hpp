#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/control/rotation.hpp"
#include "forcebound/scene/part.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/scene/scene_state.hpp"
#include "forcebound/scene/tool/tool.hpp"

namespace forcebound::scene {

/// An object of 1 N/mm and more effects.
inline PartDescription pushing(const std::string& name, NamedValues shape, std::vector<NamedValues> more = {}) {
  PartDescription part{.name = name, .shape = std::move(shape), .effects = {{"surface", {{"stiffness_N_per_m", 1e3}}}}};
  for (NamedValues& effect : more) part.effects.push_back(std::move(effect));
  return part;
}

inline PartDescription plane(std::vector<NamedValues> more = {}) {
  return pushing("plane", {"half_space", {{"through_m", Point(0, 0, 0)}, {"normal", Point(0, 0, 1)}}}, std::move(more));
}

/// @param tool no points: an ordinary point
inline std::shared_ptr<const Scene> scene_with(const std::vector<PartDescription>& objects,
                                               const std::vector<ToolPoint>& tool, const ShapeGeometry& geometry = {}) {
  SceneFacts facts{.name = "tool", .description = ""};
  if (!tool.empty()) facts.tool = std::make_shared<const Tool>(tool);
  SceneParts parts;
  for (PartDescription object : objects) {
    object.tool_radius_m = facts.tool ? facts.tool->radius_m_max() : 0;
    const bool of_mesh = object.shape->name == "mesh" || object.shape->name == "distance_field";
    parts.objects.push_back(make_part(object, Registry::standard(), 3, {}, of_mesh ? geometry : ShapeGeometry{}));
  }
  return std::make_shared<const Scene>(std::move(facts), std::move(parts));
}

inline Handle turned(const Eigen::Quaterniond& orientation) {
  return {.orientation = control::orientation_of(orientation)};
}

/// The first answer of a tool that begins there.
inline Answer touch_at(const std::shared_ptr<const Scene>& scene, const Point& tip_m,
                       const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
  return SceneState(scene, 3).answer(Vector(tip_m), Nanoseconds{0}, {}, false, turned(orientation));
}

inline std::vector<ToolPoint> points_of(std::string_view kind, const config::Values& values, double spacing_m) {
  return points_of_part(kind, values, {}, spacing_m);
}

}  // namespace forcebound::scene
