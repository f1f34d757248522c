#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/client/app/options.hpp"
#include "forcebound/record/tick_record.hpp"

namespace forcebound::client {

using NamedCounts = std::vector<std::pair<std::string, std::uint64_t>>;

/// What another program adds to a run.
struct RunAdditions {
  std::vector<record::TickSink*> sinks{};  ///< get each tick; must outlive the run
  std::function<void()> housekeeping{};    ///< called several times a second; may be empty
  std::function<NamedCounts()> counts{};   ///< at the end: "counts" of the JSON summary; may be empty
};

/// Runs the client until its time is up or `stop` is set, prints the summary on stdout and writes the requested files.
/// @param more not with a page @returns the exit code. @throws std::exception with a message of one line if it cannot
/// start.
int run(const Options& options, const std::atomic<bool>& stop, const RunAdditions& more = {});

}  // namespace forcebound::client
