#include "tests/tools/lab/teleoperation/touch_study.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "forcebound/device/load_device.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/teleoperation/last_tick.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
constexpr double kFelt_N = 0.5;
constexpr double kClear_m = 5e-4;  // so far from the wall no model of it is felt
// The script: two presses, 6 mm beyond where the tool touches; during the second the hand slides 45 mm along.
constexpr double kPress_m = 6e-3;
constexpr double kDown_s = 1;
constexpr double kHold_s = 2;
constexpr double kUp_s = 1;
constexpr double kPause_s = 1;
constexpr double kSecondDown_s = 1 + kDown_s + kHold_s + kUp_s + kPause_s;
constexpr double kSlide_s = 3;
constexpr double kSlide_m = 0.045;
constexpr double kPressed_s = kSecondDown_s + kDown_s + kHold_s;
constexpr double kEnd_s = kPressed_s + kSlide_s;

/// What a hand met on a millisecond.
struct Felt {
  double time_s = 0;     ///< since the work began
  double depth_m = 0;    ///< of the hand's place below the true wall, in the robot's world
  double force_N = 0;    ///< on the hand, out of the wall
  double against_N = 0;  ///< likewise, along the wall, against the hand's way
};

Eigen::Vector3d way_of(const server::Task& task) { return task.normal.unitOrthogonal(); }

/// Straight down, twice, from where the tool of the task starts; then along the wall.
server::Task pressing(server::Task task, double touch_height_m) {
  const Eigen::Vector3d start = task.target(0).position;
  const Eigen::Vector3d deep = start - (start.dot(task.normal) - touch_height_m + kPress_m) * task.normal;
  task.script = {{.time_s = 1, .position = start},
                 {.time_s = 1 + kDown_s, .position = deep},
                 {.time_s = 1 + kDown_s + kHold_s, .position = deep},
                 {.time_s = 1 + kDown_s + kHold_s + kUp_s, .position = start},
                 {.time_s = kSecondDown_s, .position = start},
                 {.time_s = kSecondDown_s + kDown_s, .position = deep},
                 {.time_s = kPressed_s, .position = deep},
                 {.time_s = kEnd_s, .position = deep + kSlide_m * way_of(task)}};
  task.time_s = kEnd_s;
  return task;
}

Touch touch_of(const std::vector<Felt>& all, double begin_s, double end_s) {
  Touch touch{.displayed_N_per_m = kNotKnown};
  double crossed_s = kNotKnown;
  double dragged_N = 0;  // by the robot's lag, just before the hand crosses the wall
  double before_N = kNotKnown;
  double forces_N = 0;
  double depths_m = 0;
  double count = 0;
  double least_m = std::numeric_limits<double>::infinity();
  double most_m = -least_m;
  for (const Felt& now : all) {
    if (now.time_s < begin_s || now.time_s >= end_s) continue;
    if (std::isfinite(before_N)) touch.most_N_per_ms = std::max(touch.most_N_per_ms, std::abs(now.force_N - before_N));
    before_N = now.force_N;
    if (std::isnan(crossed_s) && now.depth_m < -kClear_m) dragged_N = now.force_N;
    if (std::isnan(crossed_s) && now.depth_m > 0) crossed_s = now.time_s;
    if (!touch.felt && std::isfinite(crossed_s) && now.force_N > dragged_N + kFelt_N) {
      touch.felt = true;
      touch.felt_after_s = now.time_s - crossed_s;
      touch.depth_when_felt_m = now.depth_m;
    }
    if (now.time_s < end_s - 0.5) continue;
    forces_N += now.force_N;
    depths_m += now.depth_m;
    ++count;
    least_m = std::min(least_m, now.depth_m);
    most_m = std::max(most_m, now.depth_m);
  }
  constexpr double kAtRest_m = 5e-4;  // a tremor passes
  if (count > 0 && most_m - least_m < kAtRest_m && depths_m > 0) touch.displayed_N_per_m = forces_N / depths_m;
  return touch;
}

/// From when it slides for sure until it slows down.
double friction_of(const std::vector<Felt>& all) {
  double against_N = 0;
  double normal_N = 0;
  for (const Felt& now : all) {
    if (now.time_s < kPressed_s + kSlide_s / 3 || now.time_s > kPressed_s + 2 * kSlide_s / 3) continue;
    against_N += now.against_N;
    normal_N += now.force_N;
  }
  return normal_N > 0 ? against_N / normal_N : kNotKnown;
}

void fill(const std::vector<Felt>& felt, TouchRow& row) {
  row.first = touch_of(felt, 1, 1 + kDown_s + kHold_s);
  row.second = touch_of(felt, kSecondDown_s, kPressed_s);
  row.displayed_friction = friction_of(felt);
}

/// Where the tool's point is as it touches, along the normal: found by letting the robot do it, without a network.
double touch_height_m(const TeleoperationStudy& study) {
  TeleoperationSetup setup = setup_of(study, study.tasks.front(), "position-position", "none", network_of("none"), 1);
  std::vector<TeleoperationMoment> moments;
  (void)run_teleoperation(setup, &moments);
  const auto contact =
      std::ranges::find_if(moments, [](const TeleoperationMoment& moment) { return moment.contact_N > 0; });
  if (contact == moments.end()) throw std::runtime_error("task '" + setup.task.name + "' touches nothing");
  return contact->tool_m.dot(setup.task.normal);
}

TouchRow by_robot(const TeleoperationStudy& study, const std::string& architecture, const NamedNetwork& network,
                  double height_m) {
  TeleoperationSetup setup = setup_of(study, study.tasks.front(), architecture, study.laws.front(), network, 1);
  setup.task = pressing(std::move(setup.task), height_m);
  std::vector<TeleoperationMoment> moments;
  const TeleoperationMeasures measures = run_teleoperation(setup, &moments);
  std::vector<Felt> felt;
  felt.reserve(moments.size());
  const double pace = ScriptOperator(setup.task, {.seed = setup.seed}).pace();
  for (const TeleoperationMoment& now : moments) {
    felt.push_back({.time_s = pace * (now.time_s - ScriptOperator::kRest_s),
                    .depth_m = height_m - now.leader_m.dot(setup.task.normal),
                    .force_N = now.shown_along_N,
                    .against_N = -now.shown_in_world_N.dot(way_of(setup.task))});
  }
  TouchRow row{.architecture = architecture,
               .network = network.name,
               .leader_minimum_J = measures.leader_minimum_J,
               .follower_minimum_J = measures.follower_minimum_J};
  fill(felt, row);
  return row;
}

/// The same hand and device at a virtual wall of the task's stiffness.
TouchRow without_robot(const TeleoperationStudy& study, double height_m) {
  const TeleoperationSetup setup =
      setup_of(study, study.tasks.front(), "position-position", study.laws.front(), network_of("none"), 1);
  const server::Task task = pressing(setup.task, height_m);
  const double start_m = task.target(0).position.dot(task.normal);
  const server::WorkspaceSettings& workspace = setup.follower.workspace;
  const Eigen::Vector3d normal = workspace.rotation.transpose() * task.normal;
  const Eigen::Vector3d through = -(start_m - height_m) / workspace.motion_scale * normal;
  const auto list = [](const Eigen::Vector3d& p) {
    return "[" + text::to_text(p.x()) + ", " + text::to_text(p.y()) + ", " + text::to_text(p.z()) + "]";
  };
  ScriptOperator::Settings hand{.workspace = workspace, .seed = setup.seed};
  sim::ClosedLoop::Settings settings{
      .device = setup.device,
      .hand = {},
      .make_hand = [&] { return std::make_unique<ScriptOperator>(task, hand); },
      .law = setup.law,
      .scene = server::parse_scene(
          "[scene]\nname = 'wall'\ndescription = 'of the task'\ndegrees_of_freedom = 3\n[[object]]\nname = "
          "'wall'\nshape = { kind = 'half_space', "
          "through_m = " +
              list(through) + ", normal = " + list(normal) +
              " }\neffects = ['surface', 'friction']\n[object.surface]\nstiffness_N_per_m = " +
              text::to_text(workspace.force_scale * workspace.motion_scale * task.stiffness_N_per_m) +
              "\n[object.friction]\nstatic_coefficient = " + text::to_text(task.friction) + "\n",
          "wall"),
      .seed = setup.seed};
  LastTick last;
  sim::ClosedLoop loop(std::move(settings), {&last});
  const double pace = ScriptOperator(task, hand).pace();
  std::vector<Felt> felt;
  for (const double end_s = ScriptOperator(task, hand).duration_s(); time::to_seconds(loop.time()) < end_s;) {
    loop.run(1ms);
    const Eigen::Vector3d place = loop.device().truth().position;
    const Eigen::Vector3d shown_N = Eigen::Vector3d(last.tick().applied) / workspace.force_scale;
    felt.push_back({.time_s = pace * (time::to_seconds(loop.time()) - ScriptOperator::kRest_s),
                    .depth_m = workspace.motion_scale * (through - place).dot(normal),
                    .force_N = shown_N.dot(normal),
                    .against_N = -shown_N.dot(workspace.rotation.transpose() * way_of(task))});
  }
  TouchRow row{
      .architecture = "no robot, no network", .network = "-", .leader_minimum_J = loop.device().audit()->minimum_J};
  fill(felt, row);
  return row;
}

}  // namespace

std::vector<TouchRow> study_touches(const TeleoperationStudy& study) {
  const double height_m = touch_height_m(study);
  std::vector<TouchRow> rows{without_robot(study, height_m)};
  for (const NamedNetwork& network : study.networks) {
    for (const std::string& architecture : study.architectures) {
      rows.push_back(by_robot(study, architecture, network, height_m));
    }
  }
  return rows;
}

std::string touch_text(const std::vector<TouchRow>& rows) {
  text::Table table({{"architecture"},
                     {"1st", "ms"},
                     {"depth", "mm"},
                     {"N/mm"},
                     {"2nd", "ms"},
                     {"depth", "mm"},
                     {"N/mm"},
                     {"slid"},
                     {"N/ms"},
                     {"P", "mJ"}});
  const double alone_N_per_m = rows.front().second.displayed_N_per_m;
  std::string network = rows.front().network;
  for (const TouchRow& row : rows) {
    if (row.network != network) table.add_heading(results::network_in_words(network = row.network));
    const auto after = [](const Touch& touch) {
      return touch.felt ? text::fixed(1e3 * touch.felt_after_s, 0) : "never";
    };
    table.add({row.architecture, after(row.first), text::fixed(1e3 * row.first.depth_when_felt_m, 2),
               text::fixed(1e-3 * row.first.displayed_N_per_m, 2), after(row.second),
               text::fixed(1e3 * row.second.depth_when_felt_m, 2), text::fixed(1e-3 * row.second.displayed_N_per_m, 2),
               text::fixed(row.displayed_friction, 2),
               text::fixed(std::max(row.first.most_N_per_ms, row.second.most_N_per_ms), 2),
               results::millijoules(std::min(row.leader_minimum_J, row.follower_minimum_J))});
  }
  return table.to_text() +
         "\n  1st    from where the hand crosses the wall until it feels 0.5 N more, on the\n"
         "  2nd    first and second touch of it; depth: how deep the hand is then\n"
         "  N/mm   displayed: force over depth below the true wall, at rest; the same\n"
         "         device shows " +
         text::fixed(1e-3 * alone_N_per_m, 2) +
         " N/mm of it without robot and network\n"
         "  slid   force along the wall over that out of it, while the hand slides\n"
         "  N/ms   largest change of the force on the hand within a millisecond\n"
         "  P      least of both sides\n";
}

}  // namespace forcebound::lab
