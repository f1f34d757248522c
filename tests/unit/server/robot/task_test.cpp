#include "forcebound/server/robot/task.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>

#include "forcebound/config/config_error.hpp"
#include "tests/unit/server/robot/scripted_run.hpp"

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;

class EveryShippedTask : public testing::TestWithParam<std::string> {};

TEST_P(EveryShippedTask, IsDoneByItsScript) {
  const Task task = load_task(GetParam());
  EXPECT_FALSE(task.summary.empty());
  SimulatedArm arm(task, 1);
  ImpedanceController controller(arm.model());
  const TaskProgress progress = follow_script(task, arm, controller);
  EXPECT_TRUE(progress.succeeded) << task.measure << ": " << progress.measure << " of " << progress.goal;
  EXPECT_GT(progress.succeeded_s, 0);
  EXPECT_LT(progress.succeeded_s, task.time_s);
  EXPECT_LT(progress.peak_N, 40);
  EXPECT_EQ(arm.counters().frozen_joints, 0U);
}

TEST_P(EveryShippedTask, IsNotDoneByARobotThatStandsStill) {
  const Task task = load_task(GetParam());
  SimulatedArm arm(task, 1);
  (void)arm.read(Nanoseconds(0));
  (void)arm.read(milliseconds(3000));
  EXPECT_FALSE(arm.progress().succeeded);
  EXPECT_FALSE(arm.progress().in_contact) << "it starts away from its work";
  EXPECT_LT(std::abs(arm.progress().measure), 1e-6);
}

TEST_P(EveryShippedTask, StartsWhereItsScriptDoes) {
  const Task task = load_task(GetParam());
  const SimulatedArm arm(task, 1);
  EXPECT_LT((task.target(0).position - arm.truth().tool.position).norm(), 1e-6);
}

std::string test_name(const testing::TestParamInfo<std::string>& tested) {
  std::string name = tested.param;
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Tasks, EveryShippedTask, testing::ValuesIn(task_names()), test_name);

TEST(Task, ThereAreFive) {
  EXPECT_EQ(task_names(), (std::vector<std::string>{"block", "edge", "plug", "soft-pad", "stiff-wall"}));
}

/// Presses the tool down and lets it come to rest. @return force [N] over depth [m]
double pressed_stiffness(const Task& task, double radius_m, double low_N, double high_N) {
  SimulatedArm arm(task, 1);
  Vector6 push = Vector6::Zero();
  const auto pressed = [&](double force_N, milliseconds from) {
    push.z() = -force_N;
    arm.push(from, push);
    (void)arm.read(from + milliseconds(4000));
    return std::pair(arm.progress().force_N.z(), radius_m - arm.truth().tool.position.z());
  };
  const auto [first_N, first_m] = pressed(low_N, milliseconds(0));
  const auto [second_N, second_m] = pressed(high_N, milliseconds(4000));
  EXPECT_LT(second_N, -1) << "the tool pushes the surface down";
  return (first_N - second_N) / (second_m - first_m);
}

TEST(Task, SurfacesHaveTheStiffnessThatTheirFilesSay) {
  const Task wall = load_task("stiff-wall");
  EXPECT_NEAR(pressed_stiffness(wall, 0.01, 30, 60), wall.stiffness_N_per_m, 2e-3 * wall.stiffness_N_per_m);
  const Task pad = load_task("soft-pad");
  EXPECT_NEAR(pressed_stiffness(pad, 0.015, 30, 60), pad.stiffness_N_per_m, 2e-3 * pad.stiffness_N_per_m);
}

TEST(Task, TheBlockStandsStillOnItsTable) {
  SimulatedArm arm(load_task("block"), 1);
  (void)arm.read(Nanoseconds(0));
  const Eigen::Vector3d start = arm.truth().block.position;
  (void)arm.read(milliseconds(5000));
  EXPECT_LT((arm.truth().block.position - start).norm(), 1e-6);
}

TEST(Task, APlugBesideItsHoleStaysOut) {
  const Task task = load_task("plug");
  SimulatedArm arm(task, 1);
  Vector6 push = Vector6::Zero();
  push.z() = -60;  // 2 mm beside it, straight down
  arm.push(Nanoseconds(0), push);
  (void)arm.read(milliseconds(300));
  double deepest_m = 0;
  for (milliseconds now(300); now < milliseconds(4000); ++now) {
    (void)arm.read(now);
    deepest_m = std::min(deepest_m, arm.truth().tool.position.z());
  }
  EXPECT_GT(deepest_m, -1e-3);
  EXPECT_TRUE(arm.progress().in_contact);
}

TEST(Task, ScriptIsAtRestAtItsWaypoints) {
  const Task task = load_task("stiff-wall");
  for (const ToolWaypoint& waypoint : task.script) {
    EXPECT_LT((task.target(waypoint.time_s).position - waypoint.position).norm(), 1e-12);
    EXPECT_LT(task.target(waypoint.time_s).velocity.norm(), 1e-9);
  }
  EXPECT_EQ(task.target(-1).position, task.script.front().position);
  EXPECT_EQ(task.target(1e9).position, task.script.back().position);
}

TEST(Task, ScriptsVelocityIsTheDerivativeOfItsPosition) {
  const Task task = load_task("plug");
  constexpr double kApart_s = 1e-6;
  for (double at_s = 0.7; at_s < 11.9; at_s += 0.137) {
    const Eigen::Vector3d slope =
        (task.target(at_s + kApart_s).position - task.target(at_s - kApart_s).position) / (2 * kApart_s);
    EXPECT_LT((slope - task.target(at_s).velocity).norm(), 1e-5) << at_s;
  }
}

const std::string kWhole = R"(
summary = "touch"
degrees_of_freedom = 1
time_s = 1
tool = { kind = "fingertip", radius_m = 0.01 }
start = { position_m = [0.5, 0, 0.3] }
goal = { kind = "hold_force", time_s = 1, force_N_least = 1, force_N_most = 2 }
[[object]]
name = "wall"
shape = "surface"
position_m = [0, 0, 0]
stiffness_N_per_m = 10000
[[waypoint]]
time_s = 1
position_m = [0.5, 0, 0.3]
)";

std::string with(const std::string& old, const std::string& changed) {
  std::string text = kWhole;
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), changed);
}

std::string refusal(const std::string& text) {
  try {
    const Task task = parse_task(text, "my.toml");
    const auto robot = make_robot(task, 1);
    return "accepted";
  } catch (const std::exception& error) {
    return error.what();
  }
}

TEST(Task, RefusesWhatItDoesNotKnowOrCannotBe) {
  ASSERT_EQ(refusal(kWhole), "accepted");
  EXPECT_EQ(refusal(with("summary", "sumary")),
            "my.toml:2: task 'my': unknown key 'sumary', did you mean 'summary'? (known: summary, degrees_of_freedom, "
            "time_s, tool, start, object, goal, waypoint, spiral)");
  EXPECT_EQ(refusal(with("stiffness_N_per_m = 10000", "stiffness_N_per_m = -5")),
            "my.toml:12: object 'wall': stiffness_N_per_m must be > 0 and <= 2e+05, got -5");
  EXPECT_EQ(refusal(with("kind = \"hold_force\", time_s = 1, force_N_least = 1, force_N_most = 2",
                         "kind = \"insert\", depth_m = 1")),
            "my.toml:1: task 'my': a goal of kind 'insert' needs a plug and a hole");
  EXPECT_EQ(refusal(with("\"surface\"", "\"ball\"")).substr(0, 47), "my.toml:10: object 'wall': unknown shape 'ball'");
}

TEST(Task, RefusesAStartThatTheArmCannotReachAndNamesIt) {
  EXPECT_EQ(
      refusal(with("start = { position_m = [0.5, 0, 0.3] }", "start = { position_m = [1.5, 0, 0.3] }")).substr(0, 69),
      "task 'my': the tool cannot start at [1.5, 0, 0.3] m, turned by [0, 3.");
}

TEST(Task, OneThatDoesNotExistIsRefusedWithTheNearest) {
  try {
    (void)load_task("stiff-wal");
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "no task 'stiff-wal', did you mean 'stiff-wall'? (known: block, edge, plug, soft-pad, stiff-wall); a "
                 "file is given as FILE.toml");
  }
}

}  // namespace
}  // namespace forcebound::server
