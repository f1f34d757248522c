#include "forcebound/server/app/follower_options.hpp"

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "forcebound/program/command_line.hpp"
#include "forcebound/server/follower/architecture.hpp"
#include "forcebound/server/robot/robot_kinds.hpp"
#include "forcebound/server/robot/task.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::server {
namespace {

std::vector<std::string> architecture_names() {
  std::vector<std::string> names;
  for (const ArchitectureKind& kind : architectures()) names.emplace_back(kind.name);
  return names;
}

}  // namespace

std::vector<std::string> follower_laws(const control::LawRegistry& laws) {
  std::vector<std::string> names;
  for (const std::string& name : laws.names()) {
    if (!laws.find(name).make_server_side) names.push_back(name);
  }
  return names;
}

void expect_task(const FollowerOptions& options) {
  if (!options.any() || is_driven(options.robot) == options.task.empty()) return;
  if (!options.task.empty()) {
    throw std::invalid_argument("--task is for simulated robots; one behind a driver has work of its own");
  }
  throw std::invalid_argument("--follower " + options.robot + " requires --task: a simulated robot needs work, of " +
                              text::join(task_names()) + " or FILE.toml");
}

void add_follower_options(CLI::App& app, FollowerOptions& options, const control::LawRegistry& laws) {
  CLI::Option* const follower =
      app.add_option("--follower", options.robot,
                     "drive this robot instead of a scene: it follows the device of one client, the leader, and the "
                     "leader feels what the robot does. See Robots below")
          ->type_name("ROBOT")
          ->check(program::accepted_by([](const std::string& robot) {
            if (!is_driven(robot)) (void)find_robot(robot);
          }));
  app.add_option("--task", options.task, "with a simulated --follower: work that the robot is set up for, see below")
      ->type_name("NAME|FILE.toml")
      ->check(program::accepted_by([](const std::string& task) { (void)load_task(task); }))
      ->needs(follower);
  app.add_option("--architecture", options.settings.architecture,
                 "with --follower: which signals go which way, see below")
      ->type_name("NAME")
      ->check(program::one_of("architecture", architecture_names()))
      ->capture_default_str()
      ->needs(follower);
  const std::vector<std::string> names = follower_laws(laws);
  app.add_option("--follower-law", options.settings.law,
                 "with --follower: law that bounds the robot's torques: " + text::join(names))
      ->type_name("NAME")
      ->check(program::one_of("law", names))
      ->capture_default_str()
      ->needs(follower);
  app.add_option("--motion-scale", options.settings.workspace.motion_scale,
                 "with --follower: the robot's tool moves so many times as far as the device")
      ->type_name("M")
      ->check(program::number_within(0.01, 100))
      ->capture_default_str()
      ->needs(follower);
  app.add_option("--force-scale", options.settings.workspace.force_scale,
                 "with --follower: the device shows so many times the robot's force")
      ->type_name("K")
      ->check(program::number_within(0.001, 100))
      ->capture_default_str()
      ->needs(follower);
  app.add_option(
         "--robot-store", options.settings.initial_J,
         "with --follower: energy that the robot may spend before the leader gave any; default: that of its own "
         "mass at its speed limit, which is the most; with model-mediated half of it")
      ->type_name("J")
      ->check(program::number_within(0, 100))
      ->needs(follower);
  app.add_option("--approach-speed", options.settings.approach_m_per_s_max,
                 "with --follower: largest speed of the robot's tool that a leader gets")
      ->type_name("M_PER_S")
      ->check(program::number_within(0.001, 1))
      ->capture_default_str()
      ->needs(follower);
}

}  // namespace forcebound::server
