#include "tests/tools/lab/rendering/body_tasks.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "forcebound/device/simulated/smooth_step.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/tools/lab/accuracy/harmonic_hand.hpp"
#include "tests/tools/sim/firm_device.hpp"

namespace forcebound::lab {
namespace {

using scene::Point;

/// Where a hand is at a time.
struct PathPoint {
  double time_s = 0;
  Point place_m = Point::Zero();
};

struct BodyTask {
  const char* name;
  const char* group;
  const char* scene;  ///< what follows the head of a scene file; empty: the shipped scene of that name
  std::vector<PathPoint> path;
  bool holds = false;  ///< the hand presses button 0 all the time
};

/// At rest at each point of its path, and from one to the next smoothly.
class PathHand final : public device::Operator {
 public:
  explicit PathHand(const BodyTask& task) : path_(task.path) {
    if (task.holds) handle_.buttons = 1;
  }

  std::string_view name() const noexcept override { return "path"; }
  const device::Hand& hand() const noexcept override { return kFollowingHand; }
  int degrees_of_freedom() const noexcept override { return 3; }
  std::string description() const override { return "goes from place to place"; }
  control::Handle handle(double) const noexcept override { return handle_; }

  Target target(double time_s) const noexcept override {
    const auto next = std::ranges::upper_bound(path_, time_s, {}, &PathPoint::time_s);
    if (next == path_.begin()) return at_rest(path_.front());
    const PathPoint& from = *std::prev(next);
    if (next == path_.end()) return at_rest(from);
    const double takes_s = next->time_s - from.time_s;
    const device::SmoothStep step = device::smooth_step((time_s - from.time_s) / takes_s);
    const Point way_m = next->place_m - from.place_m;
    return {.position = from.place_m + step.value * way_m, .velocity = step.slope / takes_s * way_m};
  }

 private:
  static Target at_rest(const PathPoint& point) noexcept {
    return {.position = point.place_m, .velocity = control::Vector::Zero(3)};
  }

  std::vector<PathPoint> path_;
  control::Handle handle_{};
};

// In contacts as hard as a time step of 1 ms allows.
constexpr const char* kSled = R"(
[bodies]
contact_time_s = 0.002
probe_radius_m = 0.006
[[body]]
name = 'table'
fixed = true
friction = 0.5
shape = { kind = 'box', center_m = [0, 0, -0.05], size_m = [0.4, 0.4, 0.06] }
[[body]]
name = 'sled'
mass_kg = 0.6
friction = 0.5
shape = { kind = 'box', center_m = [0, 0, 0], size_m = [0.06, 0.06, 0.04] }
)";

constexpr const char* kStack = R"(
[bodies]
contact_time_s = 0.008
probe_radius_m = 0.006
[[body]]
name = 'table'
fixed = true
friction = 0.3
shape = { kind = 'box', center_m = [0, 0, -0.05], size_m = [0.4, 0.4, 0.06] }
[[body]]
name = 'lower box'
mass_kg = 0.2
friction = 0.3
shape = { kind = 'box', center_m = [0, 0, 0], size_m = [0.06, 0.06, 0.04] }
[[body]]
name = 'upper box'
mass_kg = 0.1
shape = { kind = 'box', center_m = [0, 0, 0.035], size_m = [0.04, 0.04, 0.03] }
)";

// Hinged at the origin, with a closer that damps it; it is pushed near its edge.
constexpr const char* kDoor = R"(
[[body]]
name = 'door'
probes = ['ball']
mjcf_text = '''
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <default><geom solref="0.008 1"/></default>
  <worldbody>
    <body name="panel">
      <joint type="hinge" axis="0 0 1" stiffness="1" damping="0.5" frictionloss="0.05"/>
      <geom type="box" pos="0.15 0 0" size="0.15 0.01 0.1" mass="1"/>
    </body>
    <body name="ball" pos="0.25 -0.03 0">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.006" mass="0.03"/>
    </body>
  </worldbody>
</mujoco>
'''
)";

// 10 mm of travel; its top is at z = 0.004.
constexpr const char* kButton = R"(
[[body]]
name = 'button'
probes = ['ball']
mjcf_text = '''
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <default><geom solref="0.004 1"/></default>
  <worldbody>
    <body name="cap">
      <joint type="slide" axis="0 0 1" stiffness="400" damping="0.5" limited="true" range="-0.01 0"/>
      <geom type="cylinder" size="0.01 0.004" mass="0.03"/>
    </body>
    <body name="ball" pos="0 0 0.02">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.006" mass="0.03"/>
    </body>
  </worldbody>
</mujoco>
'''
)";

// Too heavy for the device to be lifted: it is drawn along a smooth table.
constexpr const char* kGraspedBall = R"(
[bodies]
contact_time_s = 0.008
probe_radius_m = 0.006
grasp_button = 0
grasp_N_max = 60
[[body]]
name = 'table'
fixed = true
friction = 0.1
shape = { kind = 'box', center_m = [0, 0, -0.06], size_m = [0.4, 0.4, 0.06] }
[[body]]
name = 'ball'
mass_kg = 3
friction = 0.1
shape = { kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.03 }
)";

/// From a clearance of 20 mm: pushes a box of 60 mm along x, stops, goes back a little, and pushes again, and again.
std::vector<PathPoint> three_pushes() {
  return {{2, {-0.055, 0, 0}}, {2.8, {-0.01, 0, 0}}, {3.1, {-0.01, 0, 0}}, {3.3, {-0.02, 0, 0}},
          {4.0, {0.02, 0, 0}}, {4.4, {0.02, 0, 0}},  {4.6, {0.01, 0, 0}},  {5.4, {0.05, 0, 0}}};
}

std::vector<PathPoint> pressed_four_times() {
  constexpr double kBetweenPresses_s = 1;
  const Point above_m(0, 0, 0.02);
  const Point down_m(0, 0, 0);
  std::vector<PathPoint> path;
  for (int press = 0; press < 4; ++press) {
    const double begin_s = 2 + press * kBetweenPresses_s;
    path.insert(path.end(),
                {{begin_s, above_m}, {begin_s + 0.3, down_m}, {begin_s + 0.5, down_m}, {begin_s + 0.8, above_m}});
  }
  return path;
}

std::vector<BodyTask> tasks_of_bodies() {
  const std::vector<PathPoint> swung_open{{2, {0.25, -0.03, 0}},  {2.8, {0.25, 0.02, 0}}, {3.2, {0.25, 0.02, 0}},
                                          {4.0, {0.25, 0.06, 0}}, {4.4, {0.25, 0.05, 0}}, {5.2, {0.24, 0.1, 0}}};
  const std::vector<PathPoint> drawn_about{{2, {0, 0, 0.05}},       {2.5, {0, 0, 0.035}},     {2.7, {0, 0, 0.035}},
                                           {3.2, {0.03, 0, 0.035}}, {3.8, {-0.03, 0, 0.035}}, {4.1, {-0.03, 0, 0.035}},
                                           {4.7, {0.03, 0, 0.035}}, {5.3, {0, 0.02, 0.035}}};
  // First the lintel, then what bears it.
  const std::vector<PathPoint> post_and_lintel{
      {2, {-0.08, 0, 0.03}}, {2.8, {-0.05, 0, 0.03}}, {3.1, {-0.05, 0, 0.03}}, {3.3, {-0.09, 0, 0.03}},
      {3.6, {-0.09, 0, 0}},  {4.4, {-0.04, 0, 0}},    {4.8, {-0.04, 0, 0}},    {5.6, {-0.02, 0, 0}}};
  return {{.name = "sled of 0.6 kg", .group = "body pushed", .scene = kSled, .path = three_pushes()},
          {.name = "stack of two boxes", .group = "body pushed", .scene = kStack, .path = three_pushes()},
          {.name = "door", .group = "body pushed", .scene = kDoor, .path = swung_open},
          {.name = "blocks", .group = "body pushed", .scene = "", .path = post_and_lintel},
          {.name = "two_on_a_block", .group = "body pushed", .scene = "", .path = three_pushes()},
          {.name = "button of 30 g", .group = "body on a spring", .scene = kButton, .path = pressed_four_times()},
          {.name = "grasped ball of 3 kg",
           .group = "body held",
           .scene = kGraspedBall,
           .path = drawn_about,
           .holds = true}};
}

std::shared_ptr<const scene::Scene> scene_of(const BodyTask& task) {
  const std::string parts = task.scene;
  if (parts.empty()) return server::load_scene(task.name);
  return server::parse_scene(
      "[scene]\nname = '" + std::string(task.name) + "'\ndescription = ''\ndegrees_of_freedom = 3\n" + parts,
      "scene.toml");
}

}  // namespace

std::vector<RenderingTask> body_tasks() {
  std::vector<RenderingTask> tasks;
  for (const BodyTask& task : tasks_of_bodies()) {
    tasks.push_back({.name = task.name,
                     .group = task.group,
                     .goal = kGoalOfWhatMoves,
                     .scene = scene_of(task),
                     .device = sim::firm_device(),
                     .make_hand = [task] { return std::make_unique<const PathHand>(task); }});
  }
  return tasks;
}

}  // namespace forcebound::lab
