#include "tests/tools/lab/rendering/rendering_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "forcebound/text/names.hpp"
#include "tests/tools/lab/rendering/rendering_tasks.hpp"
#include "tests/tools/lab/rendering/true_force_meter.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using time::Nanoseconds;

// Of a run: the start, and the end after the longest blackout.
constexpr std::int64_t kStartingPart = 6;
constexpr std::int64_t kSteadyPart = 20;

RenderingCondition delayed(double round_trip_ms) {
  char words[64];
  std::snprintf(words, sizeof words, "delay %gms %gms loss 5%%", round_trip_ms / 2, round_trip_ms / 20);
  return {.name = std::to_string(std::lround(round_trip_ms)) + " ms",
          .kind = "delays",
          .network = network_of(words).settings};
}

/// Sent so far, both ways.
double bytes_sent(sim::ClosedLoop& loop) {
  const auto& [up, down] = loop.network().counters().bytes_sent;
  return static_cast<double>(up + down);
}

}  // namespace

std::vector<RenderingCondition> rendering_conditions() {
  std::vector<RenderingCondition> conditions{
      {.name = "0 ms", .kind = "delays"}, delayed(20), delayed(100), delayed(200)};
  for (const NamedNetwork& network : standard_networks().networks) {
    if (network.settings.trace)
      conditions.push_back({.name = network.name, .kind = "recorded", .network = network.settings});
  }
  for (const auto& [seconds, round_trip_ms] : {std::pair{1, 20}, {3, 100}}) {
    RenderingCondition dead = delayed(round_trip_ms);
    dead.name = "blackout " + std::to_string(seconds) + " s";
    dead.kind = "blackouts";
    dead.faults.push_back({.kind = sim::ClosedLoop::Fault::Kind::blackout, .at = 2600ms, .length = seconds * 1s});
    conditions.push_back(std::move(dead));
  }
  return conditions;
}

RenderingFigures play_rendering(const RenderingTask& task, const RenderingCondition& condition,
                                const RenderingStudySettings& study, bool local, std::uint64_t seed) {
  TrueForceMeter meter(task.scene, static_cast<std::uint32_t>(task.device.facts.translations()), task.counted_from_s);
  sim::ClosedLoop::Settings settings{.device = task.device,
                                     .hand = {},
                                     .make_hand = task.make_hand,
                                     .law = study.law,
                                     .scene = task.scene,
                                     .network = condition.network,
                                     .seed = seed,
                                     .faults = condition.faults,
                                     .renders_locally = local};
  if (local) settings.send_rate = study.send_rate;
  settings.network.seed = seed;
  sim::ClosedLoop loop(std::move(settings), {&meter});
  meter.place_of = [&loop] { return loop.device().truth().position; };
  const Nanoseconds starting = study.run / kStartingPart;
  const Nanoseconds steady = study.run / kSteadyPart;
  loop.run(starting);
  const double at_start = bytes_sent(loop);
  loop.run(study.run - starting - steady);
  const double before_the_end = bytes_sent(loop);
  loop.run(steady);
  RenderingFigures figures = meter.figures();
  figures.minimum_J = loop.device().audit().value().minimum_J;
  figures.scene_bytes = static_cast<double>(loop.totals().scene_piece_bytes);
  figures.start_B_per_s = at_start / time::to_seconds(starting);
  figures.steady_B_per_s = (bytes_sent(loop) - before_the_end) / time::to_seconds(steady);
  figures.motions_per_s = static_cast<double>(loop.totals().sent) / time::to_seconds(study.run);
  return figures;
}

std::vector<RenderingRow> study_rendering(const RenderingStudySettings& settings,
                                          const std::function<void(double)>& progress) {
  std::vector<RenderingTask> tasks = rendering_tasks();
  std::vector<std::string> names;
  names.reserve(tasks.size());
  for (const RenderingTask& task : tasks) names.push_back("'" + task.name + "'");
  std::erase_if(tasks, [&](const RenderingTask& task) {
    return task.name.find(settings.only) == std::string::npos && task.group.find(settings.only) == std::string::npos;
  });
  if (tasks.empty())
    throw std::invalid_argument("--only: no scene's name or class contains '" + settings.only + "': there are " +
                                text::join(names));
  const std::vector<RenderingCondition> conditions = rendering_conditions();
  const auto runs = [&](const RenderingTask& task, const RenderingCondition& condition, bool local) {
    std::vector<RenderingFigures> all;
    all.reserve(settings.seeds);
    for (std::uint64_t seed = 1; seed <= settings.seeds; ++seed)
      all.push_back(play_rendering(task, condition, settings, local, seed));
    return all;
  };
  std::vector<RenderingRow> rows;
  for (const RenderingTask& task : tasks) {
    const std::vector<RenderingFigures> without_network = runs(task, conditions.front(), false);
    for (const RenderingCondition& condition : conditions) {
      const bool no_delay = &condition == &conditions.front();
      rows.push_back({.task = task.name,
                      .group = task.group,
                      .goal = task.goal,
                      .condition = condition.name,
                      .kind = condition.kind,
                      .without_network = without_network,
                      .remote = no_delay ? without_network : runs(task, condition, false),
                      .local = runs(task, condition, true)});
      progress(static_cast<double>(rows.size()) / static_cast<double>(tasks.size() * conditions.size()));
    }
  }
  return rows;
}

}  // namespace forcebound::lab
