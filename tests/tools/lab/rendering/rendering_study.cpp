#include "tests/tools/lab/rendering/rendering_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
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

double error_of(const WorstRendering& worst) { return worst.row->local.at(worst.seed - 1).error; }

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
                                const RenderingStudySettings& study, bool local, std::uint64_t seed,
                                record::TickSink* course) {
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
  std::vector<record::TickSink*> sinks{&meter};
  if (course != nullptr) sinks.push_back(course);
  sim::ClosedLoop loop(std::move(settings), sinks);
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

std::vector<RenderingTask> rendering_tasks_with(const std::string& word) {
  std::vector<RenderingTask> tasks = rendering_tasks();
  std::vector<std::string> names;
  names.reserve(tasks.size());
  for (const RenderingTask& task : tasks) names.push_back("'" + task.name + "'");
  std::erase_if(tasks, [&](const RenderingTask& task) {
    return task.name.find(word) == std::string::npos && task.group.find(word) == std::string::npos;
  });
  if (tasks.empty())
    throw std::invalid_argument("--only: no scene's name or class contains '" + word + "': there are " +
                                text::join(names));
  return tasks;
}

std::vector<RenderingRow> study_rendering(const std::vector<RenderingTask>& tasks,
                                          const RenderingStudySettings& settings,
                                          const std::function<void(double)>& progress) {
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

std::vector<WorstRendering> worst_renderings(const std::vector<RenderingRow>& rows) {
  std::vector<WorstRendering> worst;
  for (const RenderingRow& row : rows) {
    for (std::uint64_t seed = 1; seed <= row.local.size(); ++seed) {
      const WorstRendering run{.row = &row, .seed = seed};
      if (worst.empty() || worst.back().row->group != row.group) {
        worst.push_back(run);
      } else if (error_of(run) > error_of(worst.back())) {
        worst.back() = run;
      }
    }
  }
  return worst;
}

std::string course_picture(const std::string& group) { return results::LawsFigure::picture_name("course " + group); }

results::LawsFigure rendering_course(const std::vector<RenderingTask>& tasks, const WorstRendering& worst,
                                     const RenderingStudySettings& settings) {
  const RenderingRow& row = *worst.row;
  const RenderingTask& task = *std::ranges::find(tasks, row.task, &RenderingTask::name);
  const std::vector<RenderingCondition> conditions = rendering_conditions();
  const RenderingCondition& condition = *std::ranges::find(conditions, row.condition, &RenderingCondition::name);
  const auto with_error = [&](const char* rendering, const std::vector<RenderingFigures>& runs) {
    return std::string(rendering) + ": E_dev " + text::fixed(runs.at(worst.seed - 1).error, 3);
  };
  results::LawsFigure figure("The worst of '" + row.group + "': " + row.task + ", " + row.condition,
                             "law " + settings.law + ", seed " + std::to_string(worst.seed) + "; " +
                                 with_error("without a network", row.without_network));
  const auto play = [&](const RenderingCondition& behind, bool local, record::TickSink& course) {
    (void)play_rendering(task, behind, settings, local, worst.seed, &course);
  };
  play(conditions.front(), false, figure.add_reference(settings.law));
  play(condition, false, figure.add_run(settings.law, with_error("remote rendering", row.remote)));
  play(condition, true, figure.add_run(settings.law, with_error("local rendering", row.local)));
  return figure;
}

}  // namespace forcebound::lab
