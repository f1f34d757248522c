#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/server/app/follower_options.hpp"
#include "forcebound/server/app/led_follower.hpp"
#include "forcebound/server/app/led_robot.hpp"
#include "forcebound/server/follower/architecture.hpp"
#include "forcebound/server/robot/robot_kinds.hpp"
#include "forcebound/server/robot/task.hpp"

namespace forcebound::server {
namespace {

/// "  NAME  what it does", a line each.
template <class Kinds>
std::string listed(const Kinds& kinds) {
  std::size_t widest = 0;
  for (const auto& kind : kinds) widest = std::max(widest, kind.name.size());
  std::string text;
  for (const auto& kind : kinds) {
    text += "  " + std::string(kind.name) + std::string(widest + 2 - kind.name.size(), ' ') +
            std::string(kind.summary) + "\n";
  }
  return text;
}

}  // namespace

void add_robot_options(CLI::App& app, StartRobot& start, const control::LawRegistry& laws) {
  const auto options = std::make_shared<FollowerOptions>();
  add_follower_options(app, *options, laws);
  app.callback([options, &start] {
    if (!options->any()) return;
    expect_task(*options);
    start = [options](const control::LawRegistry& known, const time::Clock& clock, std::optional<int> priority) {
      return start_follower(*options, known, clock, priority);
    };
  });
}

std::string robot_help() {
  std::vector<Task> tasks;
  for (const std::string& name : task_names()) tasks.push_back(load_task(name));
  return "Robots (--follower):\n" + listed(robot_kinds()) +
         "  driver:FILE.so[:KEY=VALUE,...]\n"
         "           a robot behind a driver of forcebound_device.h; facts=ROBOT.toml replaces what it tells of "
         "itself\n"
         "  ROBOT.toml\n"
         "           a robot's file, which names its driver\n"
         "\nTasks (--task):\n" +
         listed(tasks) + "or a file of your own (FILE.toml).\n\nArchitectures (--architecture):\n" +
         listed(architectures()) +
         "\n"
         "Examples with a robot:\n"
         "  forcebound-server --follower reach-7 --task stiff-wall\n"
         "      a simulated arm at a wall, led by the first client that comes\n"
         "  forcebound-server --follower driver:./my-arm.so:facts=my-arm.toml\n"
         "      a robot of your own, behind a driver\n";
}

}  // namespace forcebound::server
