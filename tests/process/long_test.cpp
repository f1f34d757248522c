#include <gtest/gtest.h>

#include <cstdio>

#include "tests/process/blackhole_checks.hpp"
#include "tests/process/loop_checks.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

constexpr auto kMinute = 60s;

void print_timing(const nlohmann::json& summary) {
  std::printf("period %s us, late ticks %s of %s\n", summary["period_us"].dump().c_str(),
              summary["late_ticks"].dump().c_str(), summary["ticks"].dump().c_str());
  std::printf("the machine's idle timer beside it: %s\n", summary.value("idle_timer", nlohmann::json()).dump().c_str());
}

TEST(AMinuteOfABadNetwork, LosesOnlyWhatTheRelayDropped) {
  const LoopOutcome outcome = run_loop({.relay = {"--netem", "delay 50ms 10ms loss 5%", "--seed", kPromptWelcomeSeed},
                                        .client = {"--device", "omni", "--operator", "trace-sphere"},
                                        .duration = kMinute});
  print_timing(outcome.summary);
  expect_sound(outcome.summary, kMinute);
  expect_exact_counts(outcome);
}

TEST(AMinuteOfADeadWay, IsNamedByTheClientsSummary) { expect_dead_ways_are_reported(kMinute); }

/// A recorded hand, touching `scene` through the recorded network's second minute: there the urban one has a blackout
/// of 7 s, and the rural one's round trip is 12 s.
void run_recorded(const std::string& scene, const std::string& network) {
  SCOPED_TRACE(scene + " through " + network);
  const auto hand = recorded_data("motion/hand-guided-a.csv");
  const auto trace = recorded_data("network/" + network);
  if (!hand || !trace) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  const TemporaryFolder folder;
  write_trace_after(*trace, kMinute, folder.file(network));
  const LoopOutcome outcome =
      run_loop({.scene = scene,
                .relay = {"--trace", folder.file(network), "--seed", "1"},
                .client = {"--device", "omni", "--operator", "replay:" + hand->string() + ",offset_x_m=0.01"},
                .duration = kMinute});
  print_timing(outcome.summary);
  expect_sound(outcome.summary, kMinute);
  std::printf("force age %s ms, blackouts %s\n", outcome.summary["force_age_ms"].dump().c_str(),
              outcome.summary["blackouts"].dump().c_str());
  EXPECT_GE(outcome.summary["blackouts"]["count"], 1);
  EXPECT_GT(outcome.summary["late_force"]["fading_ticks"], 0);
  EXPECT_GT(outcome.summary["late_force"]["dropped_ticks"], 0);
  EXPECT_GT(outcome.summary["force_age_ms"]["max"], 1000);
}

TEST(AMinuteOfARecordedHand, TouchesTheSphereThroughAnUrbanNetwork) { run_recorded("sphere", "5g-urban-n8.csv"); }
TEST(AMinuteOfARecordedHand, TouchesThePlaneThroughAnUrbanNetwork) { run_recorded("plane", "5g-urban-n8.csv"); }
TEST(AMinuteOfARecordedHand, TouchesTheSphereThroughARuralNetwork) { run_recorded("sphere", "5g-rural-n8.csv"); }
TEST(AMinuteOfARecordedHand, TouchesThePlaneThroughARuralNetwork) { run_recorded("plane", "5g-rural-n8.csv"); }

}  // namespace
}  // namespace forcebound::test
