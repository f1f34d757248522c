#include "tests/tools/lab/comparison/comparison_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/tools/lab/comparison/workers.hpp"

namespace forcebound::lab {
namespace {

TrialSetup tuning_setup(const ComparisonSettings& settings, const Task& task, std::size_t network) {
  return {.task = task,
          .stiffness_N_per_m = settings.stiffnesses_N_per_m[settings.stiffnesses_N_per_m.size() / 2],
          .network = settings.networks[network],
          .renders_locally = settings.renders_locally,
          .seed = settings.seed};
}

/// Every trial of a law, without its parameters.
std::vector<TrialRun> trials_of(const ComparisonSettings& settings, const std::string& law) {
  std::vector<TrialRun> setups;
  for (const Task& task : settings.tasks) {
    for (std::size_t network = 0; network < settings.networks.size(); ++network) {
      for (const double stiffness : settings.stiffnesses_N_per_m) {
        for (const Conditions conditions : {Conditions::ideal, Conditions::real}) {
          for (std::uint64_t seed = settings.seed; seed < settings.seed + settings.seeds; ++seed) {
            setups.push_back({.setup = {.task = task,
                                        .stiffness_N_per_m = stiffness,
                                        .network = settings.networks[network],
                                        .conditions = conditions,
                                        .law = law,
                                        .renders_locally = settings.renders_locally,
                                        .seed = seed},
                              .network = network,
                              .trial = {}});
          }
        }
      }
    }
  }
  return setups;
}

const Tuning& tuning_for(const LawInComparison& law, const TrialRun& trial_run) {
  const auto found = std::ranges::find_if(law.tuned, [&](const TunedOn& tuned) {
    return tuned.scene == trial_run.setup.task.scene && tuned.network == trial_run.network;
  });
  return found->tuning;
}

/// The parameters found on the wall through a network with that delay alone and the same device, if the comparison has
/// one; otherwise the law's standard parameters.
control::LawParameters parameters_for(const LawInComparison& law, const ComparisonSettings& settings,
                                      const std::string& device, double delay_s) {
  netem::NetemParameters delayed;
  delayed.delay.mean = time::from_seconds(delay_s);
  const auto paper = std::ranges::find_if(
      settings.tasks, [&](const Task& task) { return task.scene == "wall" && task.device == device; });
  if (paper == settings.tasks.end()) return {};
  for (const TunedOn& tuned : law.tuned) {
    const sim::SimulatedNetworkSettings& network = settings.networks[tuned.network].settings;
    if (tuned.scene == "wall" && !network.trace && network.up == delayed) return tuned.tuning.best;
  }
  return {};
}

StableStiffness limit_of(const LawInComparison& law, const ComparisonSettings& settings, const PressingHand& hand,
                         double delay_s) {
  PressedWall wall{.law = law.law, .hand = hand.specification, .delay_s = delay_s};
  wall.parameters = parameters_for(law, settings, wall.device, delay_s);
  return largest_stable({}, [&](double stiffness) { return is_stable(wall, stiffness); });
}

}  // namespace

ComparisonResult run_comparison(const ComparisonSettings& settings, const time::Clock& clock,
                                const std::function<void(std::size_t, std::size_t)>& progress) {
  ComparisonResult result{.settings = settings};
  Work tuning;
  Work trials;
  for (const std::string& law : settings.laws) {
    result.laws.push_back({.law = law, .trials = trials_of(settings, law)});
    for (const Task& task : settings.tasks) {
      for (std::size_t network = 0; network < settings.networks.size(); ++network) {
        result.laws.back().tuned.push_back({.scene = task.scene, .network = network});
      }
    }
    result.laws.back().stable.resize(settings.delays_s.size(), std::vector<StableStiffness>(pressing_hands().size()));
  }
  for (LawInComparison& law : result.laws) {
    for (std::size_t i = 0; i < law.tuned.size(); ++i) {
      tuning.emplace_back([&, i] {
        const Task& task = settings.tasks[i / settings.networks.size()];
        const TrialSetup setup = tuning_setup(settings, task, law.tuned[i].network);
        law.tuned[i].tuning = tune(law.law, {&setup, 1}, settings.effort, settings.seed);
      });
    }
    for (TrialRun& trial_run : law.trials) {
      trials.emplace_back([&] {
        trial_run.setup.parameters = tuning_for(law, trial_run).best;
        trial_run.trial = run_trial(trial_run.setup);
      });
    }
    for (std::size_t i = 0; i < settings.delays_s.size(); ++i) {
      for (std::size_t hand = 0; hand < pressing_hands().size(); ++hand) {
        trials.emplace_back([&, i, hand] {
          law.stable[i][hand] = limit_of(law, settings, pressing_hands()[hand], settings.delays_s[i]);
        });
      }
    }
  }
  Workers workers(progress);
  workers.expect(tuning.size() + trials.size());
  workers.work_off(tuning);
  workers.work_off(trials);
  for (const double delay_s : settings.delays_s) result.theory.push_back(theory_limits("wall-1dof", delay_s));
  // Measured alone on the machine, so that other work does not count.
  for (LawInComparison& law : result.laws) {
    const TrialSetup& first = law.trials.front().setup;
    law.work_ns = law.trials.front().trial.refused.empty() ? work_ns(first, clock) : std::nan("");
  }
  return result;
}

}  // namespace forcebound::lab
