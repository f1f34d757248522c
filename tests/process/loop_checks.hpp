#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "tests/process/programs.hpp"

/// A whole run of the three programs, and its checks:
///
///     client --- relay (the bad network, with its log) --- server
namespace forcebound::test {

/// With this seed the first Hello and its Welcome get through, and in less than the 100 ms after which another Hello
/// would go out: through "delay 50ms 10ms loss 5%".
inline constexpr const char* kPromptWelcomeSeed = "14";

struct LoopSettings {
  std::string scene = "sphere";
  Words relay;   ///< besides --upstream and --log
  Words client;  ///< besides --server and --summary
  std::chrono::seconds duration{8};
};

struct LoopOutcome {
  nlohmann::json summary;     ///< the client's
  std::string server_totals;  ///< what the server printed at its end
  std::string relay_log;
};

/// Runs it and ends all three in order; every program must end with 0.
LoopOutcome run_loop(const LoopSettings& settings);

/// A recorded network without its first `skipped`, written to `file`: to have the relevant part within a test's time.
void write_trace_after(const std::filesystem::path& trace, std::chrono::milliseconds skipped, const std::string& file);

/// Nearly all ticks took place, none allocated, every number is finite, and the device stayed passive. The encoder's
/// step may bring the energy slightly below zero.
void expect_sound(const nlohmann::json& summary, std::chrono::seconds duration);

/// The relay dropped every datagram that the client misses, and no other is missing.
void expect_exact_counts(const LoopOutcome& outcome);

}  // namespace forcebound::test
