#pragma once

#include <cstdint>
#include <iosfwd>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/simulated/likely_units.hpp"
#include "forcebound/law_plugin/known_laws.hpp"

namespace forcebound::client::commands {

/// `forcebound replay`: a law over recorded rows, or over rows that a simulator in any language sends as it goes.
struct ReplayOptions {
  control::LawRegistry laws = law_plugin::known_laws();
  std::string law;
  std::vector<double> damping_N_s_per_m;                           ///< one per axis, or one for all
  std::optional<std::vector<std::vector<double>>> damping_matrix;  ///< replaces it, if given
  double period_s = 1e-3;
  std::vector<double> encoder_step_m;  ///< one per axis, one for all, or none: ideal
  std::vector<double> friction_N;      ///< likewise, none: no friction
  std::optional<double> hold_s;        ///< the period, if not given
  double latency_s = 0;
  double force_N_max = std::numeric_limits<double>::infinity();
  control::LawOptions law_options{};
};

/// Counts to report after a replay.
struct ReplayCounts {
  std::uint64_t rows = 0;
  std::uint64_t requests_not_finite = 0;   ///< answered with zero force
  std::uint64_t readings_not_finite = 0;   ///< likewise, and charged to the ledger
  device::RecordedPace pace{};             ///< of all rows
  std::uint64_t intervals_impossible = 0;  ///< no time since the row before, or too much: charged to the ledger
};

/// Where the rows come from.
struct ReplayInput {
  std::istream& rows;
  std::string name;  ///< for messages
};

/// Reads `time_s,x0_m[,x1_m..],fe0_N[,fe1_N..]` and writes `time_s,f0_N[,f1_N..],energy_J,xi`: the force on the device
/// that the law allows, the energy available after the row's motion, and the share that it will credit (1 for a law
/// that has none). The first row has no motion before it, hence no energy and no force.
///
/// Positions are readings: an encoder step is a fact about them, nothing is quantised here. A law that does not use an
/// option ignores it. Each answer is flushed before the next row is asked for.
///
/// @throws std::invalid_argument naming the option that is wrong, by itself or for a file with so many axes.
/// @throws std::runtime_error `file:line: what` for a malformed row, or if the answer cannot be written.
ReplayCounts replay(const ReplayOptions& options, const ReplayInput& input, std::ostream& output);

}  // namespace forcebound::client::commands
