#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tests/tools/lab/comparison/trial.hpp"

namespace forcebound::lab {

/// How far a law is from what one wants, 0 the best: its error at the device, at most 2; one more if its contact never
/// comes to rest; one more if the device gave energy. Infinite where the law refuses.
[[nodiscard]] double score(const Trial& trial);

/// The parameters that suit a law best, of a number tried.
struct Tuning {
  control::LawParameters standard{};  ///< what the law's description says for the device
  control::LawParameters best{};
  double standard_score = 0;
  double best_score = 0;
  int tried = 0;    ///< sets of parameters, the standard ones among them; 0: the law has none to choose
  int refused = 0;  ///< sets drawn besides that the law does not accept
};

/// Tries the standard parameters, then sets drawn around them: each number between an eighth and eight times its
/// standard, evenly over the logarithm; choices as they come. What a law does not accept is drawn again. The same
/// effort for each law; the mean score over the contests counts.
///
/// @param contests whose law and parameters are replaced
[[nodiscard]] Tuning tune(const std::string& law, std::span<const Contest> contests, int effort, std::uint64_t seed);

}  // namespace forcebound::lab
