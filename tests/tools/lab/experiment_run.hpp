#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "forcebound/results/laws_figure.hpp"
#include "tests/tools/lab/trials/experiment.hpp"

namespace forcebound::lab {

/// Results of one law in one experiment.
struct ExperimentRun {
  std::string law;
  nlohmann::json summary;
  std::optional<double> ringing_s;
  double direction_error_rad = 0;

  /// Median at rest [N/m]; not a number for a contact that never rests.
  [[nodiscard]] double displayed_stiffness_N_per_m() const;
};

/// @param figure may be null; otherwise it gets the law's curves.
[[nodiscard]] ExperimentRun run_experiment(const Experiment& experiment, const std::string& law,
                                           results::LawsFigure* figure);

}  // namespace forcebound::lab
