#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/config/node.hpp"
#include "forcebound/config/parameter.hpp"
#include "forcebound/server/robot/shipped_tasks.hpp"
#include "forcebound/server/robot/task.hpp"
#include "forcebound/server/robot/task_world.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

using config::CheckedTable;
using config::ChoiceParameter;
using config::NumberParameter;
using config::Parameter;
using config::PointParameter;
using config::Values;

using Keys = std::vector<Parameter>;

NumberParameter above_zero(std::string_view key, double most) {
  return {.key = key, .least = 0, .least_excluded = true, .most = most};
}

constexpr double kFar_m = 5;
constexpr double kLong_s = 600;

/// A point within reach of any robot, or a rotation vector; three numbers.
PointParameter point(std::string_view key, const std::optional<Eigen::Vector3d>& preset = {}) {
  return {.key = key, .preset = preset, .each = {.least = -kFar_m, .most = kFar_m}};
}

Keys with_material(Keys keys) {
  // Stiffer, and a step of the simulation is too long for a light tool.
  constexpr double kStiffest_N_per_m = 2e5;
  keys.emplace_back(above_zero("stiffness_N_per_m", kStiffest_N_per_m));
  keys.emplace_back(NumberParameter{.key = "damping_s_per_m", .preset = 2, .least = 0, .most = 100});
  keys.emplace_back(NumberParameter{.key = "friction", .preset = 0.3, .least = 0, .most = 2});
  return keys;
}

ContactMaterial material_of(const Values& values) {
  return {.stiffness_N_per_m = values.number("stiffness_N_per_m"),
          .damping_s_per_m = values.number("damping_s_per_m"),
          .friction = values.number("friction")};
}

PointParameter direction(std::string_view key, const std::optional<Eigen::Vector3d>& preset = {}) {
  return {.key = key, .preset = preset, .is_direction = true};
}

WorldObject read_object(CheckedTable& table, const std::string& name) {
  using Shape = WorldObject::Shape;
  const std::string shape = table.choice({.key = "shape", .choices = {"surface", "box", "hole", "block"}});
  WorldObject object;
  object.name = name;
  const PointParameter size{.key = "size_m", .each = above_zero("size_m", kFar_m)};
  if (shape == "surface") {
    const Values values =
        table.all(with_material({point("position_m"), direction("normal", Eigen::Vector3d::UnitZ())}));
    object.normal = values.point("normal");
    object.position = values.point("position_m");
    object.material = material_of(values);
  } else if (shape == "hole") {
    object.shape = Shape::hole;
    const Values values =
        table.all(with_material({point("position_m"), above_zero("radius_m", 1), above_zero("depth_m", 1)}));
    object.position = values.point("position_m");
    object.radius_m = values.number("radius_m");
    object.depth_m = values.number("depth_m");
    object.material = material_of(values);
  } else {
    const bool moves = shape == "block";
    object.shape = moves ? Shape::block : Shape::box;
    Keys keys{point("position_m"), size, direction("normal", Eigen::Vector3d::UnitZ())};
    if (moves) keys.emplace_back(NumberParameter{.key = "mass_kg", .least = 0.1, .most = 100});
    const Values values = table.all(with_material(keys));
    object.position = values.point("position_m");
    object.normal = values.point("normal");
    object.half_size = 0.5 * values.point("size_m");
    if (moves) object.mass_kg = values.number("mass_kg");
    object.material = material_of(values);
  }
  return object;
}

ToolShape read_tool(CheckedTable table) {
  ToolShape tool;
  const std::string kind = table.choice({.key = "kind", .choices = {"fingertip", "plug"}});
  if (kind == "fingertip") {
    tool.radius_m = table.all(Keys{above_zero("radius_m", 0.1)}).number("radius_m");
    return tool;
  }
  tool.kind = ToolShape::Kind::plug;
  const Values values =
      table.all(Keys{above_zero("radius_m", 0.1), above_zero("length_m", 0.5), above_zero("chamfer_m", 0.05)});
  tool.radius_m = values.number("radius_m");
  tool.length_m = values.number("length_m");
  tool.chamfer_m = values.number("chamfer_m");
  if (tool.chamfer_m >= tool.radius_m) table.refuse("chamfer_m", "less than radius_m");
  return tool;
}

/// The tool's orientation that points straight down, turned by a rotation vector in the world frame.
Eigen::Quaterniond turned_down(const Eigen::Vector3d& rotation) {
  const Eigen::Quaterniond down(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()));
  const double angle = rotation.norm();
  if (angle == 0) return down;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle)) * down;
}

ToolPose read_start(CheckedTable table) {
  const Values values = table.all(Keys{point("position_m"), point("rotation_rad", Eigen::Vector3d::Zero())});
  return {.position = values.point("position_m"), .orientation = turned_down(values.point("rotation_rad"))};
}

TaskGoal read_goal(CheckedTable table) {
  using Kind = TaskGoal::Kind;
  TaskGoal goal;
  const std::string kind = table.choice({.key = "kind", .choices = {"hold_force", "slide", "insert", "push"}});
  if (kind == "hold_force") {
    const Values values = table.all(
        Keys{above_zero("time_s", kLong_s), above_zero("force_N_least", 1e3), above_zero("force_N_most", 1e3)});
    goal.least = values.number("time_s");
    goal.force_N_least = values.number("force_N_least");
    goal.force_N_most = values.number("force_N_most");
    if (goal.force_N_most <= goal.force_N_least) table.refuse("force_N_most", "more than force_N_least");
  } else if (kind == "insert") {
    goal.kind = Kind::insert;
    goal.least = table.all(Keys{above_zero("depth_m", 1)}).number("depth_m");
  } else {
    goal.kind = kind == "slide" ? Kind::slide : Kind::push;
    const Values values = table.all(Keys{above_zero("distance_m", kFar_m), direction("direction")});
    goal.least = values.number("distance_m");
    goal.direction = values.point("direction");
  }
  return goal;
}

std::string measure_of(const TaskGoal& goal) {
  switch (goal.kind) {
    case TaskGoal::Kind::hold_force:
      return "time with the force within its band [s]";
    case TaskGoal::Kind::slide:
      return "way slid in contact [m]";
    case TaskGoal::Kind::insert:
      return "depth of the plug [m]";
    case TaskGoal::Kind::push:
      break;
  }
  return "way of the block [m]";
}

/// Waypoints are a list in the order of their times.
void read_script(CheckedTable& file, Task& task) {
  for (const config::Node& node : file.list("waypoint")) {
    const std::string place = "waypoint " + std::to_string(task.script.size() + 1);
    if (node.as<config::Node::Table>() == nullptr) file.fail(node, place + " must be a table");
    CheckedTable table(node, file.file(), place);
    const Values values = table.all(Keys{NumberParameter{.key = "time_s", .least = 0, .most = kLong_s},
                                         point("position_m"), point("rotation_rad", Eigen::Vector3d::Zero()),
                                         NumberParameter{.key = "grip", .preset = 0, .least = 0, .most = 1}});
    const double time_s = values.number("time_s");
    if (!task.script.empty() && time_s <= task.script.back().time_s) {
      table.refuse("time_s", "later than the waypoint's before");
    }
    task.script.push_back({.time_s = time_s,
                           .position = values.point("position_m"),
                           .rotation = values.point("rotation_rad"),
                           .grip = values.number("grip")});
  }
  if (task.script.empty()) file.refuse("waypoint", "one at least");
  if (file.find("spiral") == nullptr) return;
  CheckedTable table = file.table("spiral");
  const Values values =
      table.all(Keys{NumberParameter{.key = "begin_s", .least = 0, .most = kLong_s}, above_zero("end_s", kLong_s),
                     above_zero("turns", 100), above_zero("radius_m", 0.1)});
  task.spiral = {.begin_s = values.number("begin_s"),
                 .end_s = values.number("end_s"),
                 .turns = values.number("turns"),
                 .radius_m = values.number("radius_m")};
  if (task.spiral.end_s <= task.spiral.begin_s) table.refuse("end_s", "more than begin_s");
}

void check_together(const CheckedTable& file, const Task::World& world) {
  using Shape = WorldObject::Shape;
  const auto count = [&](Shape shape) { return std::ranges::count(world.objects, shape, &WorldObject::shape); };
  if (world.objects.empty()) file.fail("needs an [[object]] to work on");
  if (count(Shape::block) > 1) file.fail("may have one object of shape 'block'");
  if (count(Shape::block) == 1 && count(Shape::surface) == 0) file.fail("a block needs a surface below it");
  const bool plug = world.tool.kind == ToolShape::Kind::plug;
  if (plug != (count(Shape::hole) == 1))
    file.fail("a tool of kind 'plug' needs one object of shape 'hole', and a hole a plug");
  if (plug && world.find(Shape::hole)->radius_m <= world.tool.radius_m) {
    file.fail("the hole's radius_m must be more than the plug's");
  }
  if (world.goal.kind == TaskGoal::Kind::insert && !plug) file.fail("a goal of kind 'insert' needs a plug and a hole");
  if (world.goal.kind == TaskGoal::Kind::push && count(Shape::block) == 0)
    file.fail("a goal of kind 'push' needs a block");
}

std::string named_task(std::string_view name) { return "tasks/" + std::string(name) + ".toml"; }

bool is_task_file(std::string_view name_or_file) {
  return name_or_file.find('/') != std::string_view::npos || name_or_file.ends_with(".toml");
}

}  // namespace

Task parse_task(std::string_view text, const std::string& file_name) {
  const config::Node node = config::parse_toml(text, file_name);
  Task task;
  task.name = std::filesystem::path(file_name).stem().string();
  CheckedTable file(node, file_name, "task '" + task.name + "'");
  // First: a misspelt table is why another error comes.
  for (const char* const key :
       {"summary", "degrees_of_freedom", "time_s", "tool", "start", "object", "goal", "waypoint", "spiral"}) {
    (void)file.find(key);
  }
  file.refuse_unknown_keys();
  auto world = std::make_shared<Task::World>();
  task.summary = file.text("summary");
  task.degrees_of_freedom = file.whole({.key = "degrees_of_freedom", .least = 1, .most = 6});
  task.time_s = file.number(above_zero("time_s", kLong_s));
  world->tool = read_tool(file.table("tool", "tool"));
  world->start = read_start(file.table("start", "start"));
  file.each("object", [&](CheckedTable& object, const std::string& name) {
    world->objects.push_back(read_object(object, name));
  });
  world->goal = read_goal(file.table("goal", "goal"));
  read_script(file, task);
  check_together(file, *world);
  task.measure = measure_of(world->goal);
  // The first object is what the task is about.
  task.stiffness_N_per_m = world->objects.front().material.stiffness_N_per_m;
  task.friction = world->objects.front().material.friction;
  task.normal = world->objects.front().normal;
  task.world = std::move(world);
  return task;
}

Task load_task(const std::string& name_or_file) {
  if (is_task_file(name_or_file)) {
    return parse_task(text::read_file(name_or_file, config::kTomlBytesMost), name_or_file);
  }
  for (const text::EmbeddedText& task : shipped_tasks()) {
    if (task.name == name_or_file) return parse_task(task.text, named_task(task.name));
  }
  throw std::invalid_argument("no task '" + text::printable(name_or_file) + "'" +
                              text::suggestion(name_or_file, task_names()) + "; a file is given as FILE.toml");
}

std::vector<std::string> task_names() {
  std::vector<std::string> names;
  for (const text::EmbeddedText& task : shipped_tasks()) names.emplace_back(task.name);
  return names;
}

}  // namespace forcebound::server
