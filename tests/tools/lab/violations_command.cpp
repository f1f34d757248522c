#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/trials/experiment.hpp"
#include "tests/tools/reference/kinematic_adversary.hpp"

namespace forcebound::lab {
namespace {

using test::DeviceTruth;
using test::KinematicGame;

struct ViolationsOptions {
  std::uint64_t seeds = 20;
  bool markdown = false;
};

/// One way in which a device may not be as its facts say.
struct Violation {
  std::string name;
  std::function<void(DeviceTruth&)> is;
  double latency_s = 100e-6;
  double friction_N = 0;
};

void lose_track(DeviceTruth& truth) {
  truth.impossible_intervals = 0.25;
  truth.lost_readings = 0.1;
}

std::vector<Violation> violations() {
  return {{"none", [](DeviceTruth&) {}},
          {"stamps off by 5 us",
           [](DeviceTruth& t) {
             t.stamp_s = {-5e-6, 5e-6};
           }},
          {"stamps off by 30 us",
           [](DeviceTruth& t) {
             t.stamp_s = {-30e-6, 30e-6};
           }},
          {"readings up to 125 us old (USB)",
           [](DeviceTruth& t) {
             t.stamp_s = {-125e-6, 0};
           }},
          {"clock off by 500 ppm", [](DeviceTruth& t) { t.clock_share = 500e-6; }},
          {"latency longer by 0 to 50 us",
           [](DeviceTruth& t) {
             t.latency_s = {0, 50e-6};
           }},
          {"latency longer by a constant 0 to 50 us",
           [](DeviceTruth& t) {
             t.latency_offset_s = {0, 50e-6};
           }},
          {"latency longer by a constant 0 to 1 ms",
           [](DeviceTruth& t) {
             t.latency_offset_s = {0, 1e-3};
           }},
          {"latency longer by 0 to 1 ms (USB)",
           [](DeviceTruth& t) {
             t.latency_s = {0, 1e-3};
           }},
          {"release off by 10 %",
           [](DeviceTruth& t) {
             t.hold_s = {-0.2e-3, 0.2e-3};
           }},
          {"release up to 50 % early", [](DeviceTruth& t) { t.early_release_share = 0.5; }},
          {"encoder off by 0.3 steps", [](DeviceTruth& t) { t.encoder_steps = 0.3; }},
          {"damping lower by 1 %", [](DeviceTruth& t) { t.damping_share = 0.01; }},
          {"friction lower by 20 %", [](DeviceTruth& t) { t.friction_share = 0.2; }, 100e-6, 0.5},
          {"torque gain off by 1 %",
           [](DeviceTruth& t) {
             t.torque_gain_share = {-0.01, 0.01};
           }},
          {"torque gain off by 3 %",
           [](DeviceTruth& t) {
             t.torque_gain_share = {-0.03, 0.03};
           }},
          {"torque gain off by 10 %",
           [](DeviceTruth& t) {
             t.torque_gain_share = {-0.1, 0.1};
           }},
          {"torque ripple of 1 %", [](DeviceTruth& t) { t.torque_ripple_share = 0.01; }},
          {"actuator lag of 100 us", [](DeviceTruth& t) { t.actuator_lag_s = 100e-6; }},
          {"1 % of writes fail, reported", [](DeviceTruth& t) { t.failed_writes = 0.01, t.failures_reported = true; }},
          {"1 % of writes fail, not reported", [](DeviceTruth& t) { t.failed_writes = 0.01; }},
          {"1 % of readings lose a count", [](DeviceTruth& t) { t.lost_counts = 0.01; }},
          {"impossible intervals, lost readings, latency 0", lose_track, 0},
          {"impossible intervals, lost readings, latency 300 us", lose_track, 300e-6},
          {"impossible intervals, lost readings, latency 1 ms", lose_track, 1e-3},
          {"5 us, 20 us, 2 %, 500 ppm, 0.1 step", [](DeviceTruth& t) {
             t.stamp_s = {-5e-6, 5e-6};
             t.latency_s = {0, 20e-6};
             t.hold_s = {-40e-6, 40e-6};
             t.clock_share = 500e-6;
             t.encoder_steps = 0.1;
           }}};
}

KinematicGame game_of(const Violation& violation, const std::string& device) {
  KinematicGame game;
  game.facts = device::load_device(device).facts;
  game.facts.latency_s = violation.latency_s;
  game.facts.friction.setConstant(violation.friction_N);
  violation.is(game.truth);
  return game;
}

double least_J(KinematicGame game, std::uint64_t seeds) {
  double least_J = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    game.seed = seed;
    game.late_ticks = seed % 2 == 0;
    control::ExactLaw law(game.facts);
    least_J = std::min(least_J, static_cast<double>(test::least_P_J(law, game)));
  }
  return least_J;
}

/// Stiffness that a wall or a ball shows with facts of such bounds [N/mm].
std::string displayed(const Experiment& experiment, const control::DeviceFacts& facts) {
  sim::ClosedLoop::Settings settings = experiment.settings("fba-exact");
  settings.device.facts.uncertainty = facts.uncertainty;
  settings.device.facts.latency_s = facts.latency_s;
  settings.device.facts.friction = facts.friction;
  sim::ClosedLoop loop(settings);
  loop.run(time::from_seconds(experiment.duration_s));
  const auto summary = nlohmann::ordered_json::parse(loop.close().to_json());
  return results::newtons_per_mm(results::number_at(summary, "/displayed_stiffness_N_per_m/median"));
}

text::Table::Cell leak_cell(double least_P_J) {
  const std::string leak = results::millijoules(least_P_J);
  return {leak, leak == "0" ? text::Table::Mark::none : text::Table::Mark::alarm};
}

void run(const ViolationsOptions& options) {
  struct Place {
    std::string device;
    Experiment experiment;
  };
  const std::vector<Place> places{{"wall-1dof", experiments("wall").back()},
                                  {"cartesian-3dof", experiments("sphere").front()}};
  text::Table table({{"what is not as the facts say"},
                     {"told exact", "mJ"},
                     {"told bounds", "mJ"},
                     {"shown, told exact", "N/mm"},
                     {"shown, told bounds", "N/mm"}});
  const auto all = violations();
  program::Progress progress;
  std::size_t done = 0;
  for (const Place& place : places) {
    table.add_heading(place.device);
    for (const Violation& violation : all) {
      progress.report(static_cast<double>(done++) / static_cast<double>(places.size() * all.size()), violation.name);
      KinematicGame game = game_of(violation, place.device);
      const double exact_J = least_J(game, options.seeds);
      const std::string shown_exact = displayed(place.experiment, game.facts);
      game.facts.uncertainty = test::uncertainty_of(game.truth, game.facts);
      table.add({violation.name, leak_cell(exact_J), leak_cell(least_J(game, options.seeds)), shown_exact,
                 displayed(place.experiment, game.facts)});
    }
  }
  progress.clear();
  std::cout << "Least P of fba-exact against an opponent that is hand, environment and clock at\n"
               "once, in "
            << text::counted(options.seeds, "game")
            << " of 2 s each; and the stiffness that a wall of 150 N/mm or a\n"
               "ball of 10 N/mm shows.\n\n"
            << (options.markdown ? table.to_markdown() : table.to_text(text::colour_for(STDOUT_FILENO)));
}

}  // namespace

void add_violations(CLI::App& app) {
  auto options = std::make_shared<ViolationsOptions>();
  CLI::App* command = app.add_subcommand(
      "violations", "What each untrue fact of a device makes fba-exact leak, and what telling its bounds costs");
  command->add_option("--seeds", options->seeds, "games for each row")
      ->check(program::whole_within(1, 1'000'000'000))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--markdown", options->markdown, "print the table as Markdown");
  command->footer("Example:\n  forcebound-lab violations --seeds 5");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
