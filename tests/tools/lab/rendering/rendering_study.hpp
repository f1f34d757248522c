#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "forcebound/results/laws_figure.hpp"
#include "tests/tools/lab/rendering/rendering_task.hpp"
#include "tests/tools/lab/rendering/true_force_meter.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// A network, and what goes wrong in it.
struct RenderingCondition {
  std::string name;
  std::string kind;  ///< "delays", "recorded" or "blackouts"
  sim::SimulatedNetworkSettings network{};
  std::vector<sim::ClosedLoop::Fault> faults{};
};

/// First no delay, where remote rendering is as without a network; 20, 100 and 200 ms round trip with 10 % of jitter
/// and 5 % of loss; the recorded networks that are at hand; blackouts of 1 s within 20 ms and of 3 s within 100 ms.
[[nodiscard]] std::vector<RenderingCondition> rendering_conditions();

/// One task through one condition: a run for each seed.
struct RenderingRow {
  std::string task;
  std::string group;
  RenderingGoal goal{};
  std::string condition;
  std::string kind;  ///< of the condition
  std::vector<RenderingFigures> without_network{};
  std::vector<RenderingFigures> remote{};
  std::vector<RenderingFigures> local{};
};

struct RenderingStudySettings {
  std::string law = "fba-exact";
  std::uint64_t seeds = 3;
  client::SendRate send_rate{};  ///< of motions, where rendering is local
  time::Nanoseconds run = std::chrono::seconds{6};
};

/// @param course sees every tick as well, unless it is null
RenderingFigures play_rendering(const RenderingTask& task, const RenderingCondition& condition,
                                const RenderingStudySettings& settings, bool local, std::uint64_t seed,
                                record::TickSink* course = nullptr);

/// The tasks whose name or class has the word; all, if it is empty.
/// @throws std::invalid_argument with the names that there are, if none has it
[[nodiscard]] std::vector<RenderingTask> rendering_tasks_with(const std::string& word);

[[nodiscard]] std::vector<RenderingRow> study_rendering(const std::vector<RenderingTask>& tasks,
                                                        const RenderingStudySettings& settings,
                                                        const std::function<void(double)>& progress);

/// Of all runs of a class of scenes, the one with the largest E_dev of local rendering.
struct WorstRendering {
  const RenderingRow* row;
  std::uint64_t seed;
};

/// One for each class, in the order of the rows, which must outlive them.
[[nodiscard]] std::vector<WorstRendering> worst_renderings(const std::vector<RenderingRow>& rows);

/// The file of the picture of a class: "course-body-pushed.png".
[[nodiscard]] std::string course_picture(const std::string& group);

/// What was felt over time in such a run, remote beside local and without a network behind both (laws.gnuplot): three
/// runs.
/// @param tasks with the row's
[[nodiscard]] results::LawsFigure rendering_course(const std::vector<RenderingTask>& tasks, const WorstRendering& worst,
                                                   const RenderingStudySettings& settings);

}  // namespace forcebound::lab
