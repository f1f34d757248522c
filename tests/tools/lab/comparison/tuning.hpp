#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tests/tools/lab/comparison/trial.hpp"

namespace forcebound::lab {

/// Score of a law, 0 the best: its error at the device, at most 2; plus 1 if its contact never comes to rest; plus 1 if
/// the device was not passive. Infinite where the law refuses.
[[nodiscard]] double score(const Trial& trial);

/// The parameters with the best score, of a number tried.
struct Tuning {
  control::LawParameters standard{};  ///< the law's standard parameters for the device
  control::LawParameters best{};
  double standard_score = 0;
  double best_score = 0;
  int tried = 0;    ///< sets of parameters, including the standard ones; 0: the law has no parameters
  int refused = 0;  ///< sets drawn besides that the law does not accept
};

/// Tries the standard parameters, then sets drawn around them: each number between an eighth and eight times its
/// standard, evenly over the logarithm; choices uniformly. Sets that a law does not accept are drawn again. The same
/// effort for each law; the mean score over the setups counts.
///
/// @param setups whose law and parameters are replaced
[[nodiscard]] Tuning tune(const std::string& law, std::span<const TrialSetup> setups, int effort, std::uint64_t seed);

}  // namespace forcebound::lab
