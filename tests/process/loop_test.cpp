#include <gtest/gtest.h>

#include <cmath>

#include "tests/process/loop_checks.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

TEST(ThreeProgramsOnABadNetwork, StayPassiveAndAgreeExactlyOnEveryDatagram) {
  const LoopOutcome outcome = run_loop({.relay = {"--netem", "delay 50ms 10ms loss 5%", "--seed", kPromptWelcomeSeed},
                                        .client = {"--device", "omni", "--operator", "trace-sphere"},
                                        .duration = 8s});
  expect_sound(outcome.summary, 8s);
  expect_exact_counts(outcome);

  const nlohmann::json& summary = outcome.summary;
  EXPECT_EQ(summary["law"], "fba-exact");
  EXPECT_EQ(summary["device"], "omni");
  EXPECT_GT(summary["contact_ticks"].get<int>(), 0);
  // At least twice 50 ms and at most 10 ms more or less each way; that of the newest force is rather less than the
  // mean.
  EXPECT_GE(summary["rtt_us"]["p50"].get<double>(), 80e3);
  EXPECT_GE(summary["force_age_ms"]["p50"].get<double>(), 80);
  EXPECT_LE(summary["force_age_ms"]["p50"], summary["force_age_ms"]["p99"]);
  EXPECT_LE(summary["force_age_ms"]["p99"], summary["force_age_ms"]["max"]);
  // 5 % each way, within five standard deviations: 0.25 % each where no tick was skipped and 7800 were sent.
  const double sent = summary["sent"].get<double>();
  EXPECT_NEAR(summary["lost_up"].get<double>() / sent, 0.05, 5 * std::sqrt(0.05 * 0.95 / sent));
  EXPECT_EQ(summary["faults"]["reconnects"], 0);
}

}  // namespace
}  // namespace forcebound::test
