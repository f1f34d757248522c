#include "forcebound/record/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/record/sample_ticks.hpp"

namespace forcebound::record {
namespace {

using ::testing::HasSubstr;

TEST(Summary, HasEveryPromisedKey) {
  Summary summary(test::sample_info());
  test::play_sample_run(summary, 3000);
  summary.finish(test::sample_totals());
  const json object = json_of(summary);
  for (const char* pointer : {"/law",
                              "/device",
                              "/operator",
                              "/scene",
                              "/duration_s",
                              "/ticks",
                              "/period_us/p50",
                              "/period_us/p99",
                              "/period_us/p999",
                              "/period_us/max",
                              "/late_ticks",
                              "/sent",
                              "/received",
                              "/lost",
                              "/duplicated",
                              "/reordered",
                              "/stale_ticks",
                              "/force_age_ms/p50",
                              "/force_age_ms/p99",
                              "/force_age_ms/max",
                              "/rtt_us/p50",
                              "/rtt_us/p99",
                              "/rtt_us/max",
                              "/compute_us/p50",
                              "/compute_us/p99",
                              "/force_N/mean",
                              "/force_N/variance",
                              "/force_N/max",
                              "/penetration_m/mean",
                              "/penetration_m/max",
                              "/displayed_stiffness_N_per_m/mean",
                              "/displayed_stiffness_N_per_m/median",
                              "/bounded_fraction",
                              "/passivity/minimum_J",
                              "/passivity/final_J",
                              "/passivity/ok",
                              "/ledger/final_J",
                              "/faults/malformed_corrupt"}) {
    const json::json_pointer key(pointer);
    ASSERT_TRUE(object.contains(key)) << pointer;
    EXPECT_FALSE(object[key].is_null()) << pointer;
  }
  EXPECT_EQ(object["lost"], 270);
  EXPECT_EQ(object["faults"]["malformed_corrupt"], 2);
  EXPECT_EQ(object["run"]["seed"], 18446744073709551615U);
}

TEST(Summary, TakesForceInContactOnly) {
  Summary summary(RunInfo{});
  summary.on_tick(tick_at(1));
  summary.on_tick(contact_at(2, 1, 1e-3));
  summary.on_tick(contact_at(3, 3, 1e-3));
  TickRecord apart = tick_at(4);
  apart.applied = vector_of({9});
  summary.on_tick(apart);
  const json object = json_of(summary);
  EXPECT_DOUBLE_EQ(object["force_N"]["mean"], 2);
  EXPECT_DOUBLE_EQ(object["force_N"]["variance"], 1);
  EXPECT_DOUBLE_EQ(object["force_N"]["max"], 9);
  EXPECT_DOUBLE_EQ(object["bounded_fraction"], 0.25);
  EXPECT_DOUBLE_EQ(object["duration_s"], 0.003);
}

TEST(Summary, ShowsAStiffnessAtRestOnly) {
  Summary summary(RunInfo{});
  // Comes in at 50 mm/s, then rests 1 mm deep for a second, and is pulled out as fast.
  for (std::uint64_t n = 1; n <= 20; ++n) summary.on_tick(contact_at(n, 9, 5e-5 * static_cast<double>(n)));
  for (std::uint64_t n = 21; n <= 1020; ++n) summary.on_tick(contact_at(n, n % 4 == 0 ? 4 : 2, 1e-3));
  for (std::uint64_t n = 1021; n <= 1040; ++n) summary.on_tick(contact_at(n, 9, 5e-5 * static_cast<double>(1041 - n)));
  const json object = json_of(summary);
  // Of the landing and the leaving, the few ticks count whose depth is within 0.1 mm of that at rest.
  EXPECT_NEAR(object["displayed_stiffness_N_per_m"]["mean"], 2500, 30);
  EXPECT_NEAR(object["displayed_stiffness_N_per_m"]["median"], 2000, 2);
  EXPECT_NEAR(object["at_rest"]["force_N"], 2, 2e-3);
  EXPECT_NEAR(object["at_rest"]["penetration_m"], 1e-3, 1e-6);
  EXPECT_NEAR(object["at_rest"]["fraction"], 982.0 / 1040, 6.0 / 1040);
  EXPECT_DOUBLE_EQ(object["at_rest"]["speed_m_per_s_max"], 5e-3);
}

TEST(Summary, ShowsNoStiffnessOfAContactThatNeverRests) {
  Summary summary(RunInfo{});
  for (std::uint64_t n = 1; n <= 1000; ++n) {
    summary.on_tick(contact_at(n, 5, 1e-3 + 2e-4 * std::sin(0.3 * static_cast<double>(n))));
  }
  const json object = json_of(summary);
  EXPECT_TRUE(object["displayed_stiffness_N_per_m"]["mean"].is_null());
  EXPECT_TRUE(object["displayed_stiffness_N_per_m"]["median"].is_null());
  EXPECT_EQ(object["at_rest"]["fraction"], 0);
  EXPECT_THAT(summary.to_text(), HasSubstr("at rest       never"));
}

TEST(Summary, HasNoDepthWhereTheSurfaceIsUnknown) {
  Summary summary(RunInfo{});
  for (std::uint64_t n = 1; n <= 1000; ++n) {
    // The newest answer touched the surface, but far from where the device is now.
    summary.on_tick(contact_at(n, 2, n <= 600 ? std::numeric_limits<double>::quiet_NaN() : 1e-3));
  }
  const json object = json_of(summary);
  EXPECT_EQ(object["contact_ticks"], 1000);
  EXPECT_EQ(object["surface_unknown_ticks"], 600);
  EXPECT_DOUBLE_EQ(object["penetration_m"]["mean"], 1e-3);
  EXPECT_DOUBLE_EQ(object["penetration_m"]["max"], 1e-3);
  EXPECT_NEAR(object["displayed_stiffness_N_per_m"]["median"], 2000, 2);
  EXPECT_THAT(summary.to_text(), HasSubstr("not known on 60 % of the ticks"));
}

TEST(Summary, LeavesOutShallowContactAndTheTimeToSettle) {
  RunInfo info;
  info.settle_s = 0.050;
  info.stiffness_depth_m_min = 1e-4;
  Summary summary(info);
  for (std::uint64_t n = 1; n <= 50; ++n) summary.on_tick(contact_at(n, 100, 1.5e-4));
  for (std::uint64_t n = 51; n <= 150; ++n) summary.on_tick(contact_at(n, 2, n % 2 == 0 ? 1.5e-4 : 0.9e-4));
  const json object = json_of(summary);
  EXPECT_DOUBLE_EQ(object["force_N"]["mean"], 2);
  EXPECT_DOUBLE_EQ(object["force_N"]["max"], 100);
  EXPECT_NEAR(object["displayed_stiffness_N_per_m"]["mean"], 2 / 1.5e-4, 1e-6);
}

TEST(Summary, DoesNotTakeRoundingForBounding) {
  RunInfo info;
  info.rounding_N = 0.01;
  Summary summary(info);
  TickRecord tick = tick_at(1);
  tick.request = vector_of({1.0});
  tick.applied = vector_of({0.992});
  summary.on_tick(tick);
  tick.applied = vector_of({0.98});
  summary.on_tick(tick);
  EXPECT_DOUBLE_EQ(json_of(summary)["bounded_fraction"], 0.5);
}

TEST(Summary, DoesNotTakeTheDevicesLargestForceForBounding) {
  RunInfo info;
  info.force_N_max = 3;
  Summary summary(info);
  TickRecord tick = tick_at(1);
  tick.request = vector_of({30, 40});
  tick.applied = 3.0 / 50 * tick.request;
  summary.on_tick(tick);
  tick.request = vector_of({1e200, 1e200});
  tick.applied = vector_of({3 / std::sqrt(2), 3 / std::sqrt(2)});
  summary.on_tick(tick);
  tick.request = tick.applied = vector_of({1, 2});
  summary.on_tick(tick);
  tick.request = vector_of({30, 40});
  tick.applied = 2.9 / 50 * tick.request;  // bounded by the law
  summary.on_tick(tick);
  EXPECT_DOUBLE_EQ(json_of(summary)["bounded_fraction"], 0.25);
}

TEST(Summary, CountsTicksLateByMoreThanHalfAMillisecond) {
  Summary summary(RunInfo{});
  for (const std::int64_t us : {5000, 1000, 1500, 1501, 2700}) {  // the first tick has no interval yet
    TickRecord tick = tick_at(1);
    tick.interval = std::chrono::microseconds{us};
    summary.on_tick(tick);
  }
  const json object = json_of(summary);
  EXPECT_EQ(object["late_ticks"], 2);
  EXPECT_DOUBLE_EQ(object["period_us"]["max"], 2700);
}

TEST(Summary, CountsBlackoutsLongerThanTheHoldTime) {
  Summary summary(RunInfo{});
  summary.on_tick(tick_at(1));  // no force yet: not a blackout
  for (std::uint64_t n = 2; n < 2000; ++n) {
    const bool no_force = (n > 500 && n < 700) || (n > 1000 && n < 1400);
    if (!no_force) summary.on_force(force_at(n, n));
    summary.on_tick(tick_at(n));
  }
  const json object = json_of(summary);
  EXPECT_EQ(object["blackouts"]["count"], 1);
  EXPECT_DOUBLE_EQ(object["blackouts"]["longest_s"], 0.399);
}

TEST(Summary, GivesEachMotionOneFate) {
  Summary summary(test::sample_info());
  EXPECT_TRUE(json_of(summary)["motions"].is_null()) << "an incomplete run does not know";
  summary.finish(test::sample_totals());
  const json object = json_of(summary);
  const json& motions = object["motions"];
  EXPECT_EQ(motions["sent"], 5000);
  EXPECT_EQ(motions["answered"], 4700);
  EXPECT_EQ(motions["unanswered"], 30);
  EXPECT_EQ(motions["lost_up"], 115);
  EXPECT_EQ(motions["lost_down"], 150);
  EXPECT_EQ(motions["in_flight"], 5);
  EXPECT_EQ(object["lost_up"], 120) << "what is on its way counts as lost there, as ever";
  EXPECT_THAT(
      summary.to_text(),
      HasSubstr(
          "5000 sent = 4700 answered + 30 unanswered + 115 lost up + 150\n                lost down + 5 in flight"));
}

TEST(Summary, SaysWhatDiedInTheLongestBlackout) {
  Summary summary(test::sample_info());
  summary.finish(test::sample_totals());
  const json longest = json_of(summary)["blackouts"]["longest"];
  EXPECT_EQ(longest["died"], "down");
  EXPECT_EQ(longest["motions"], 399);
  EXPECT_EQ(longest["lost_up"], 1);
  EXPECT_EQ(longest["answers"], 398);
  EXPECT_EQ(longest["lost_down"], 397);
  summary.finish({});
  EXPECT_TRUE(json_of(summary)["blackouts"]["longest"].is_null()) << "there was none";
}

TEST(Summary, AttributesTheRoundTripToStages) {
  Summary summary(RunInfo{});
  ForceRecord force = force_at(100, 50);
  force.round_trip = std::chrono::milliseconds{50};
  force.force.server_receive_time = std::chrono::seconds{7};  // another clock altogether
  force.force.server_send_time = force.force.server_receive_time + std::chrono::microseconds{300};
  force.force.compute_time = std::chrono::microseconds{100};
  summary.on_force(force);
  TickRecord tick = tick_at(101);
  tick.force_sequence = 50;
  tick.force_age = std::chrono::milliseconds{51};
  summary.on_tick(tick);
  const json stages = json_of(summary)["stages_us"];
  EXPECT_DOUBLE_EQ(stages["network"]["max"], 49'700);
  EXPECT_DOUBLE_EQ(stages["server"]["max"], 200);
  EXPECT_DOUBLE_EQ(stages["wait"]["max"], 1000);
}

TEST(Summary, AddingDoesNotAllocate) {
  if (!forcebound::time::kCountsHeapOperations) GTEST_SKIP() << "allocations are not counted under sanitizers";
  Summary summary(test::sample_info());
  const auto before = forcebound::time::heap_operations_of_this_thread();
  test::play_sample_run(summary, 2000);
  EXPECT_EQ(forcebound::time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::record
