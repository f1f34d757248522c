#include "tests/tools/lab/comparison/tuning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/tools/sim/draw.hpp"

#include "forcebound/law_plugin/known_laws.hpp"

namespace forcebound::lab {
namespace {

constexpr double kErrorMost = 2;
constexpr double kForgiven_J = -1e-6;  // energy from a real encoder's rounding does not affect the choice
constexpr double kFactorMost = 8;

double mean_score(const std::string& law, std::span<const TrialSetup> setups,
                  const control::LawParameters& parameters) {
  double sum = 0;
  for (TrialSetup setup : setups) {
    setup.law = law;
    setup.parameters = parameters;
    sum += score(run_trial(setup));
  }
  return sum / static_cast<double>(setups.size());
}

// Most draws for each set that a law accepts.
constexpr int kDrawsMost = 50;

control::LawParameters drawn(const control::LawDescription& law, const control::LawParameters& standard,
                             sim::Draw& draw) {
  control::LawParameters parameters;
  for (const control::LawParameter& parameter : law.parameters) {
    const double share = draw.share();
    if (!parameter.choices.empty()) {
      const auto index = static_cast<std::size_t>(share * static_cast<double>(parameter.choices.size()));
      parameters[parameter.name] = parameter.choices[index];
    } else {
      const double factor = std::pow(kFactorMost, 2 * share - 1);
      parameters[parameter.name] = std::clamp(standard.at(parameter.name) * factor, parameter.least, parameter.most);
    }
  }
  return parameters;
}

}  // namespace

double score(const Trial& trial) {
  if (!trial.refused.empty()) return std::numeric_limits<double>::infinity();
  const double error = std::isfinite(trial.error) ? std::min(trial.error, kErrorMost) : kErrorMost;
  return error + (trial.calm ? 0 : 1) + (trial.passivity_minimum_J < kForgiven_J ? 1 : 0);
}

Tuning tune(const std::string& law, std::span<const TrialSetup> setups, int effort, std::uint64_t seed) {
  const control::LawRegistry laws = law_plugin::known_laws();
  const control::LawDescription& description = laws.find(law);
  const control::DeviceFacts facts = settings_of(setups.front()).device.facts;
  Tuning tuning{.standard = laws.parameters(law, facts)};
  tuning.best = tuning.standard;
  if (description.parameters.empty()) return tuning;
  sim::Draw draw(seed);
  tuning.standard_score = tuning.best_score = mean_score(law, setups, tuning.standard);
  tuning.tried = 1;
  while (tuning.tried < effort && tuning.refused < kDrawsMost * effort) {
    const control::LawParameters parameters = drawn(description, tuning.standard, draw);
    if (!laws.refusal(law, facts, {.parameters = parameters}).empty()) {
      ++tuning.refused;
      continue;
    }
    ++tuning.tried;
    const double tried = mean_score(law, setups, parameters);
    if (!(tried < tuning.best_score)) continue;
    tuning.best_score = tried;
    tuning.best = parameters;
  }
  return tuning;
}

}  // namespace forcebound::lab
