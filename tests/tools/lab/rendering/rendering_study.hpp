#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

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
  std::string only{};            ///< tasks whose name or group has it; empty: all
  client::SendRate send_rate{};  ///< of motions, where rendering is local
  time::Nanoseconds run = std::chrono::seconds{6};
};

[[nodiscard]] RenderingFigures play_rendering(const RenderingTask& task, const RenderingCondition& condition,
                                              const RenderingStudySettings& settings, bool local, std::uint64_t seed);

/// @throws std::invalid_argument with the names that there are, if none has the word
[[nodiscard]] std::vector<RenderingRow> study_rendering(const RenderingStudySettings& settings,
                                                        const std::function<void(double)>& progress);

}  // namespace forcebound::lab
