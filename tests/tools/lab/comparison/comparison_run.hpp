#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/tools/lab/comparison/stable_stiffness.hpp"
#include "tests/tools/lab/comparison/trial.hpp"
#include "tests/tools/lab/comparison/tuning.hpp"

namespace forcebound::lab {

/// What is compared: every law on every task, through every network, against every stiffness, with an ideal device
/// and a real one.
struct ComparisonSettings {
  std::vector<std::string> laws;
  std::vector<Task> tasks;
  std::vector<NamedNetwork> networks;
  std::vector<double> stiffnesses_N_per_m;
  std::vector<double> delays_s{};  ///< each way, to look for the largest stable stiffness at; none: not looked for
  std::uint64_t seeds = 1;         ///< runs of each
  int effort = 16;                 ///< sets of parameters tried for each law that has any; 1: the standard ones
  std::uint64_t seed = 1;
  bool renders_locally = false;  ///< what can be at the client
};

/// A trial's settings and result.
struct TrialRun {
  TrialSetup setup;
  std::size_t network = 0;  ///< index among the settings'
  Trial trial;
};

/// The parameters that a law got on one task through one network.
struct TunedOn {
  std::string scene;
  std::size_t network = 0;  ///< its place among the settings'
  Tuning tuning{};
};

struct LawInComparison {
  std::string law;
  std::vector<TunedOn> tuned{};
  std::vector<TrialRun> trials{};
  double work_ns = 0;                                  ///< a tick of its own, on the first task
  std::vector<std::vector<StableStiffness>> stable{};  ///< for each delay, for each of the pressing hands
};

struct ComparisonResult {
  ComparisonSettings settings;
  std::vector<TheoryLimits> theory{};  ///< for each delay
  std::vector<LawInComparison> laws{};
};

/// Runs the comparison on the machine's processors; the result does not depend on their number.
///
/// Each law's parameters are searched for on each task through each network, against the middle stiffness, with the
/// real device.
/// @param clock the machine's, for the laws' work
/// @param progress called with the numbers of trials done and of all, from any thread, one at a time
[[nodiscard]] ComparisonResult run_comparison(const ComparisonSettings& settings, const time::Clock& clock,
                                              const std::function<void(std::size_t done, std::size_t all)>& progress);

}  // namespace forcebound::lab
