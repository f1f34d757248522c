#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "forcebound/text/terminal.hpp"

namespace forcebound::lab {

/// A device's imperfections that the laws' proofs do not assume.
struct PassivityCondition {
  std::string law;
  double encoder_m = 0;
  bool late_ticks = false;  ///< 20 % of them, by up to a period
  double latency_s = 0;     ///< from the reading to the actuator
  std::string adversary;
};

/// The least P of an adversary under a condition.
struct PassivityResult {
  PassivityCondition condition;
  double least_P_J = 0;
  std::uint64_t seed = 0;  ///< of the worst run; 0: none was below zero
};

struct PassivitySettings {
  std::uint64_t seeds = 3;
  std::uint64_t from = 1;
  double duration_s = 4;
};

/// Encoders 0, 15 and 55 um, ticks exact and late, latency 0, 20, 100 and 300 us, each hostile environment: for all
/// laws.
[[nodiscard]] std::vector<PassivityCondition> passivity_conditions();

/// Runs the paper's device (30 N s/m) with a restless hand, server without network.
[[nodiscard]] PassivityResult worst_passivity(const PassivityCondition& condition, const PassivitySettings& settings);

/// The worst over all adversaries, a block for each law.
[[nodiscard]] std::string passivity_table(const std::vector<PassivityResult>& results, text::Colour colour);

/// A row for each result, the data of leaks.gnuplot: law,encoder_m,late_share,latency_s,adversary,least_P_J,seed.
[[nodiscard]] std::string passivity_csv(const std::vector<PassivityResult>& results);

}  // namespace forcebound::lab
