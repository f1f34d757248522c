#include "forcebound/server/follower/follower_appearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "forcebound/control/rotation.hpp"
#include "forcebound/server/robot/task_world.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::server {
namespace {

using Kind = scene::VisiblePart::Kind;

constexpr const char* kLeader = "leader";
constexpr std::size_t kValuesMost = 19;
constexpr double kNever = -1;  // as an age

/// Square tiles around a round hole, with its side and its bottom; the normal is z.
scene::VisiblePart plate_with(const WorldObject& hole) {
  constexpr std::uint32_t kCorners = 48;
  constexpr double kHalfEdge_m = 0.06;
  scene::VisiblePart plate{.name = hole.name, .kind = Kind::mesh};
  std::vector<scene::Point>& vertices = plate.vertices_m;
  // Rings: the square's edge, the hole's edge above and below.
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    const scene::Point way(std::cos(angle), std::sin(angle), 0);
    const double to_edge = kHalfEdge_m / std::max(std::abs(way.x()), std::abs(way.y()));
    vertices.emplace_back(hole.position + to_edge * way);
    vertices.emplace_back(hole.position + hole.radius_m * way);
    vertices.emplace_back(hole.position + hole.radius_m * way - scene::Point(0, 0, hole.depth_m));
  }
  vertices.emplace_back(hole.position - scene::Point(0, 0, hole.depth_m));
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const std::uint32_t here = 3 * i;
    const std::uint32_t next = 3 * ((i + 1) % kCorners);
    for (const std::uint32_t ring : {0U, 1U}) {
      plate.triangles.push_back({here + ring, next + ring, next + ring + 1});
      plate.triangles.push_back({here + ring, next + ring + 1, here + ring + 1});
    }
    plate.triangles.push_back({here + 2, next + 2, 3 * kCorners});
  }
  return plate;
}

scene::VisiblePart part_of(const WorldObject& object) {
  switch (object.shape) {
    case WorldObject::Shape::surface:
      return {.name = object.name,
              .kind = Kind::half_space,
              .place_m = object.position,
              .turn = control::turn_between(Eigen::Vector3d::UnitZ(), object.normal)};
    case WorldObject::Shape::hole:
      return plate_with(object);
    case WorldObject::Shape::box:
    case WorldObject::Shape::block:
      break;
  }
  return {.name = object.name, .kind = Kind::box, .half_m = object.half_size, .place_m = object.position};
}

/// A part of what the gripper holds, in the tool's frame.
struct Held {
  scene::VisiblePart part;
  Eigen::Isometry3d in_tool{Eigen::Isometry3d::Identity()};
};

std::vector<Held> parts_of(const ToolShape& tool) {
  constexpr double kRod_m = 0.07;  // from the gripper's palm: the tool is fixed there, however the fingers stand
  const auto behind = [](double length_m) { return Eigen::Isometry3d(Eigen::Translation3d(0, 0, -length_m / 2)); };
  const double half_m = tool.radius_m / 2;
  std::vector<Held> parts{{.part = {.name = "rod", .kind = Kind::cylinder, .half_m = {half_m, half_m, kRod_m / 2}},
                           .in_tool = behind(kRod_m)}};
  if (tool.kind == ToolShape::Kind::plug) {
    parts.push_back(
        {.part = {.name = "tool", .kind = Kind::cylinder, .half_m = {tool.radius_m, tool.radius_m, tool.length_m / 2}},
         .in_tool = behind(tool.length_m)});
  } else {
    parts.push_back(
        {.part = {.name = "tool", .kind = Kind::sphere, .half_m = Eigen::Vector3d::Constant(tool.radius_m)}});
  }
  return parts;
}

std::string facts_in_json(const RobotModel& model, const Task* task, const FollowerSettings& settings,
                          std::size_t solids, bool is_audited) {
  const nlohmann::json facts{{"name", model.name()},
                             {"task", task == nullptr ? "" : task->summary},
                             {"architecture", settings.architecture},
                             {"law", settings.law},
                             {"motion_scale", settings.workspace.motion_scale},
                             {"force_scale", settings.workspace.force_scale},
                             {"store_J", settings.store_J},
                             {"solids", solids},  // so many shapes from the first on are the robot's
                             {"audited", is_audited}};
  return facts.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Eigen::Isometry3d frame_of_pose(const ToolPose& pose) noexcept {
  return Eigen::Translation3d(pose.position) * pose.orientation;
}

}  // namespace

FollowerAppearance::FollowerAppearance(const RobotModel& model, const Task* task, const FollowerSettings& settings,
                                       bool is_audited)
    : model_(model) {
  view::MovingGroup moving;
  view::ShownScene shown{.name = task == nullptr ? std::string(model.name()) : task->name};
  // Names are numbered: an object of the task may have that of a link.
  const auto add = [&](scene::VisiblePart part, const Solid& solid) {
    part.name += " " + std::to_string(solids_.size());
    view::add_part(shown, part);
    moving.names.push_back(std::move(part.name));
    solids_.push_back(solid);
  };
  moving.names.emplace_back(kLeader);
  solids_.push_back({.on = Solid::On::leader});
  view::add_frame(shown, kLeader, settings.workspace.motion_scale);
  for (const LinkShape& shape : model.shapes()) {
    add(shape.part, {.link = shape.link, .place = shape.in_link, .opens_m = shape.opens_m});
  }
  const auto held = task == nullptr ? std::vector<Held>() : parts_of(task->world->tool);
  for (const Held& part : held) add(part.part, {.on = Solid::On::tool, .place = part.in_tool});
  shown.robot = facts_in_json(model, task, settings, solids_.size(), is_audited);
  if (task != nullptr) {
    for (const WorldObject& object : task->world->objects) {
      if (object.shape == WorldObject::Shape::block) {
        add(part_of(object),
            {.on = Solid::On::block, .place = Eigen::Isometry3d(Eigen::Translation3d(object.position))});
      } else {
        view::add_part(shown, part_of(object));  // it stays
      }
    }
  }
  const view::MovingGroup values{.names = value_names(is_audited), .values = true};
  values_ = values.names.size();
  description_ =
      std::make_shared<const view::Description>(view::describe(std::move(shown), {}, {std::move(moving), values}));
}

std::vector<std::string> FollowerAppearance::value_names(bool is_audited) {
  std::vector<std::string> names{
      "state",     "tool_x_m",     "tool_y_m",     "tool_z_m",     "force_x_N",         "force_y_N",
      "force_z_N", "torque_x_N_m", "torque_y_N_m", "torque_z_N_m", "leader_has_clutch", "lag_m",
      "drift_m",   "store_J",      "received_J",   "grip_waits",   "bias_age_s"};
  if (is_audited) names.insert(names.end(), {"passivity_J", "least_passivity_J"});
  return names;
}

std::size_t FollowerAppearance::sample(const FollowerReport& report, std::size_t group, std::size_t first,
                                       std::span<float> to) const noexcept {
  // Without a reading nobody knows where anything is.
  if (report.picture.joint.rows() == 0) return 0;
  if (group == kSolids) return sample_solids(report, first, to);
  return group == kValues ? sample_values(report, first, to) : 0;
}

std::size_t FollowerAppearance::sample_solids(const FollowerReport& report, std::size_t first,
                                              std::span<float> to) const noexcept {
  const FollowerPicture& picture = report.picture;
  const LinkFrames links = model_.link_frames(picture.joint);
  const Eigen::Isometry3d tool = frame_of_pose(picture.tool);
  const auto place_of = [&](const Solid& solid) -> Eigen::Isometry3d {
    switch (solid.on) {
      case Solid::On::link: {
        const Eigen::Isometry3d own = Eigen::Translation3d(picture.opening * solid.opens_m) * solid.place;
        return solid.link < 0 ? own : links[static_cast<std::size_t>(solid.link)] * own;
      }
      case Solid::On::tool:
        return tool * solid.place;
      case Solid::On::block:
        return picture.block ? frame_of_pose(*picture.block) : solid.place;
      case Solid::On::leader:
        return report.map.leader_frame();
    }
    return solid.place;
  };
  std::size_t count = 0;
  for (std::size_t i = first; i < solids_.size() && count + scene::kNumbersOfSolid <= to.size(); ++i) {
    const Eigen::Isometry3d place = place_of(solids_[i]);
    const Eigen::Quaterniond turn(place.linear());
    for (const double number : {place.translation().x(), place.translation().y(), place.translation().z(), turn.w(),
                                turn.x(), turn.y(), turn.z()}) {
      to[count++] = static_cast<float>(number);
    }
  }
  return count;
}

std::size_t FollowerAppearance::sample_values(const FollowerReport& report, std::size_t first,
                                              std::span<float> to) const noexcept {
  const FollowerPicture& now = report.picture;
  constexpr double kNobody = -1;
  const double leader_has_clutch = !now.leader_has_clutch ? kNobody : *now.leader_has_clutch ? 1 : 0;
  const std::array<double, kValuesMost> values{static_cast<double>(report.state),
                                               now.tool.position.x(),
                                               now.tool.position.y(),
                                               now.tool.position.z(),
                                               now.sensed_N.x(),
                                               now.sensed_N.y(),
                                               now.sensed_N.z(),
                                               now.sensed_N_m.x(),
                                               now.sensed_N_m.y(),
                                               now.sensed_N_m.z(),
                                               leader_has_clutch,
                                               now.lag_m,
                                               now.drift_m,
                                               now.store_J,
                                               now.received_J,
                                               now.grip_waits ? 1.0 : 0.0,
                                               now.bias_age ? time::to_seconds(*now.bias_age) : kNever,
                                               now.port.energy_J,
                                               now.port.minimum_J};
  std::size_t count = 0;
  for (std::size_t i = first; i < values_ && count < to.size(); ++i) to[count++] = static_cast<float>(values.at(i));
  return count;
}

}  // namespace forcebound::server
