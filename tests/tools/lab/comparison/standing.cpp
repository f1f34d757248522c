#include "tests/tools/lab/comparison/standing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "tests/tools/lab/trials/percentile.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;
using Number = double (*)(const TrialRun&);

/// The median; null without values. NaN is ignored.
Json median(const std::vector<const TrialRun*>& trials, Number number) {
  std::vector<double> values;
  for (const TrialRun* const trial_run : trials) {
    const double value = number(*trial_run);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values.empty() ? Json(nullptr) : Json(percentile(std::move(values), 0.5));
}

double most(const std::vector<const TrialRun*>& trials, Number number) {
  double value = 0;
  for (const TrialRun* const trial_run : trials) value = std::max(value, number(*trial_run));
  return value;
}

double worst_J(const std::vector<const TrialRun*>& trials) {
  double value = 0;
  for (const TrialRun* const trial_run : trials) value = std::min(value, trial_run->trial.passivity_minimum_J);
  return value;
}

double calm_share(const std::vector<const TrialRun*>& trials) {
  const auto calm = std::ranges::count_if(trials, [](const TrialRun* trial_run) { return trial_run->trial.calm; });
  return trials.empty() ? 0 : static_cast<double>(calm) / static_cast<double>(trials.size());
}

double shown(const TrialRun& trial_run) { return trial_run.trial.shown_N_per_m / trial_run.setup.stiffness_N_per_m; }
double ripple(const TrialRun& trial_run) { return trial_run.trial.restlessness; }
double variance(const TrialRun& trial_run) { return trial_run.trial.force_N2_variance; }
double error(const TrialRun& trial_run) { return trial_run.trial.error; }
double ringing_s(const TrialRun& trial_run) { return trial_run.trial.ringing_s.value_or(std::nan("")); }
double direction_deg(const TrialRun& trial_run) { return trial_run.trial.direction_error_rad * 180 / std::numbers::pi; }
double drift_mm(const TrialRun& trial_run) { return 1e3 * trial_run.trial.drift_m; }

template <typename Take>
std::vector<const TrialRun*> trials_where(const LawInComparison& law, Take take) {
  std::vector<const TrialRun*> taken;
  for (const TrialRun& trial_run : law.trials) {
    if (trial_run.trial.refused.empty() && take(trial_run)) taken.push_back(&trial_run);
  }
  return taken;
}

Json behind(const LawInComparison& law, std::size_t network) {
  const auto trials = trials_where(law, [&](const TrialRun& trial_run) {
    return trial_run.network == network && trial_run.setup.conditions == Conditions::real;
  });
  return {{"shown", median(trials, shown)},
          {"ripple", median(trials, ripple)},
          {"error", median(trials, error)},
          {"calm", calm_share(trials)},
          {"least_P_J", worst_J(trials)}};
}

Json tuned(const LawInComparison& law) {
  Json all = Json::array();
  for (const auto& [scene, network, tuning] : law.tuned) {
    if (tuning.tried == 0) continue;
    all.push_back({{"scene", scene},
                   {"network", network + 1},
                   {"standard", tuning.standard},
                   {"best", tuning.best},
                   {"standard_score", std::isfinite(tuning.standard_score) ? Json(tuning.standard_score) : Json()},
                   {"best_score", std::isfinite(tuning.best_score) ? Json(tuning.best_score) : Json()},
                   {"tried", tuning.tried},
                   {"refused", tuning.refused}});
  }
  return all;
}

Json refusals(const LawInComparison& law) {
  Json all = Json::object();
  for (const TrialRun& trial_run : law.trials) {
    if (!trial_run.trial.refused.empty()) all[trial_run.setup.task.scene] = trial_run.trial.refused;
  }
  return all;
}

Json standing(const ComparisonResult& result, const LawInComparison& law) {
  const auto ideal = trials_where(law, [](const TrialRun& p) { return p.setup.conditions == Conditions::ideal; });
  const auto real = trials_where(law, [](const TrialRun& p) { return p.setup.conditions == Conditions::real; });
  const auto passive = [](const TrialRun* trial_run) { return trial_run->trial.passivity_minimum_J >= kPassive_J; };
  Json networks = Json::array();
  for (std::size_t i = 0; i < result.settings.networks.size(); ++i) networks.push_back(behind(law, i));
  Json stable = Json::array();
  for (const std::vector<StableStiffness>& of_hands : law.stable) {
    Json hands = Json::array();
    for (const StableStiffness& limit : of_hands) {
      hands.push_back({{"N_per_m", limit.N_per_m}, {"no_limit", limit.no_limit}});
    }
    stable.push_back(std::move(hands));
  }
  const control::LawRegistry laws = law_plugin::known_laws();
  Json told{{"law", law.law},
            {"reference", laws.find(law.law).reference},
            {"refused", refusals(law)},
            {"trials", real.size()},
            {"ideal", {{"least_P_J", worst_J(ideal)}, {"passive", std::ranges::count_if(ideal, passive)}}},
            {"real", {{"least_P_J", worst_J(real)}, {"passive", std::ranges::count_if(real, passive)}}},
            {"calm", calm_share(real)},
            {"variance_N2", median(real, variance)},
            {"ringing_s", median(real, ringing_s)},
            {"direction_deg", most(real, direction_deg)},
            {"drift_mm", most(real, drift_mm)},
            {"work_ns", std::isfinite(law.work_ns) ? Json(law.work_ns) : Json()},
            {"behind", std::move(networks)},
            {"stable", std::move(stable)},
            {"tuned", tuned(law)}};
  std::uint64_t faults = 0;
  for (const TrialRun& trial_run : law.trials) faults += trial_run.trial.law_faults;
  if (faults > 0) told["law_faults"] = faults;
  return told;
}

void add_cell(std::ostream& row, double value) {
  row << ',';
  if (std::isfinite(value)) row << value;
}

}  // namespace

Json standings(const ComparisonResult& result) {
  const ComparisonSettings& settings = result.settings;
  Json all{{"scenes", Json::array()}, {"networks", Json::array()}};
  for (const Task& task : settings.tasks) {
    all["scenes"].push_back({{"scene", task.scene}, {"device", task.device}, {"hand", task.hand}});
  }
  for (const NamedNetwork& network : settings.networks) all["networks"].push_back(network.name);
  all["stiffnesses_N_per_m"] = settings.stiffnesses_N_per_m;
  all["seeds"] = settings.seeds;
  all["effort"] = settings.effort;
  all["rendering"] = settings.renders_locally ? "local" : "remote";
  all["limits"] = Json::array();
  for (std::size_t i = 0; i < settings.delays_s.size(); ++i) {
    all["limits"].push_back({{"delay_s", settings.delays_s[i]},
                             {"passive_N_per_m", result.theory[i].passive_N_per_m},
                             {"delayed_N_per_m", result.theory[i].delayed_N_per_m},
                             {"free_N_per_m", result.theory[i].free_N_per_m}});
  }
  all["hands"] = Json::array();
  for (const PressingHand& hand : pressing_hands()) {
    all["hands"].push_back({{"hand", hand.name}, {"operator", hand.specification}});
  }
  all["laws"] = Json::array();
  for (const LawInComparison& law : result.laws) all["laws"].push_back(standing(result, law));
  return all;
}

std::string to_csv(const ComparisonResult& result) {
  control::ClassicText rows;
  rows.precision(9);
  rows << "law,scene,device,network,conditions,stiffness_N_per_m,seed,passivity_minimum_J,calm,ringing_s,"
          "displayed_stiffness_N_per_m,force_mean_N,force_variance_N2,restlessness,device_error,direction_error_rad,"
          "drift_m,refused\n";
  for (const LawInComparison& law : result.laws) {
    for (const auto& [setup, network, trial] : law.trials) {
      rows << law.law << ',' << setup.task.scene << ',' << setup.task.device << ",\"" << setup.network.name << "\","
           << (setup.conditions == Conditions::ideal ? "ideal" : "real") << ',' << setup.stiffness_N_per_m << ','
           << setup.seed;
      if (!trial.refused.empty()) {
        rows << ",,,,,,,,,,,\"" << trial.refused << "\"\n";
        continue;
      }
      rows << ',' << trial.passivity_minimum_J << ',' << (trial.calm ? 1 : 0);
      for (const double value :
           {trial.ringing_s.value_or(std::nan("")), trial.shown_N_per_m, trial.force_N_mean, trial.force_N2_variance,
            trial.restlessness, trial.error, trial.direction_error_rad, trial.drift_m}) {
        add_cell(rows, value);
      }
      rows << ",\n";
    }
  }
  return rows.str();
}

}  // namespace forcebound::lab
