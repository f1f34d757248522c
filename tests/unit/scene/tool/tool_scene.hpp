#pragma once

#include <Eigen/Geometry>
#include <chrono>
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

inline constexpr double kPush_N_per_m = 1e3;
inline constexpr double kPressed_m = 1e-3;

/// An object of kPush_N_per_m and more effects.
inline PartDescription pushing(const std::string& name, NamedValues shape, std::vector<NamedValues> more = {}) {
  PartDescription part{
      .name = name, .shape = std::move(shape), .effects = {{"surface", {{"stiffness_N_per_m", kPush_N_per_m}}}}};
  for (NamedValues& effect : more) part.effects.push_back(std::move(effect));
  return part;
}

inline PartDescription plane(std::vector<NamedValues> more = {}) {
  return pushing("plane", {"half_space", {{"through_m", Point(0, 0, 0)}, {"normal", Point(0, 0, 1)}}}, std::move(more));
}

/// @param tool no points: an ordinary point
inline std::shared_ptr<const Scene> scene_with(const std::vector<PartDescription>& objects,
                                               const std::vector<ToolPoint>& tool, const ShapeGeometry& geometry = {},
                                               ToolContact contact = ToolContact::penalty,
                                               const std::vector<ToolPart>& convex = {}) {
  SceneFacts facts{.name = "tool", .description = ""};
  if (!tool.empty()) facts.tool = std::make_shared<const Tool>(tool, contact, convex);
  SceneParts parts;
  for (PartDescription object : objects) {
    object.tool_reach_m = facts.tool ? facts.tool->reach_of_points_m() : 0;
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

/// A tick is 1 ms.
inline Answer felt_at(SceneState& state, int tick, const Point& tip_m,
                      const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
  return state.answer(Vector(tip_m), std::chrono::milliseconds{tick}, {}, false, turned(orientation));
}

inline std::vector<ToolPoint> points_of(std::string_view kind, const config::Values& values, double spacing_m) {
  return points_of_part(kind, values, {}, spacing_m);
}

/// Of 40 x 20 x 30 mm about the tip; with as many points as it has corners, unless they are to be nearer to each other.
inline std::vector<ToolPoint> block(double spacing_m = 0.05) {
  return points_of("box", {{"center_m", Point(0, 0, 0)}, {"size_m", Point(0.04, 0.02, 0.03)}}, spacing_m);
}

}  // namespace forcebound::scene
