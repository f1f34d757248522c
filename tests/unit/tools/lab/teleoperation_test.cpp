#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/tools/lab/teleoperation/fault_study.hpp"
#include "tests/tools/lab/teleoperation/free_space_study.hpp"
#include "tests/tools/lab/teleoperation/lurch_meter.hpp"
#include "tests/tools/lab/teleoperation/teleoperation_results.hpp"
#include "tests/tools/lab/teleoperation/touch_study.hpp"

namespace forcebound::lab {
namespace {

TeleoperationRow row(const std::string& architecture, double tracking_m, double force_N, bool succeeded = true,
                     double robot_J = 0) {
  TeleoperationRow row{.task = "plug", .architecture = architecture, .law = "fba-exact", .network = "none", .seed = 1};
  row.measures.tracking_rms_m = tracking_m;
  row.measures.force_error_rms_N = force_N;
  row.measures.succeeded = succeeded;
  row.measures.follower_minimum_J = robot_J;
  return row;
}

TEST(TeleoperationResults, TheFrontHasWhatNobodyBeatsInEveryRespect) {
  const auto groups = groups_of({row("a", 1e-3, 2), row("b", 2e-3, 1), row("c", 2e-3, 2), row("d", 3e-3, 3, false),
                                 row("e", 1e-4, 0.1, true, -1e-3)});
  ASSERT_EQ(groups.size(), 5U);
  EXPECT_TRUE(groups[0].on_front);
  EXPECT_TRUE(groups[1].on_front);
  EXPECT_FALSE(groups[2].on_front) << "a is nearer, b feels truer";
  EXPECT_FALSE(groups[3].on_front);
  EXPECT_FALSE(groups[4].on_front) << "it leaks";
}

TEST(TeleoperationResults, SeedsBecomeMediansAndTheLeastP) {
  auto rows = std::vector{row("a", 1e-3, 2), row("a", 3e-3, std::nan(""), false, -2e-3), row("a", 2e-3, 4)};
  const auto groups = groups_of(rows);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].runs, 3U);
  EXPECT_EQ(groups[0].succeeded, 2U);
  EXPECT_EQ(groups[0].median.tracking_rms_m, 2e-3);
  EXPECT_EQ(groups[0].median.force_error_rms_N, 3) << "of those that are known";
  EXPECT_EQ(groups[0].median.follower_minimum_J, -2e-3);
}

TEST(TeleoperationResults, AFileHasARowForEachRun) {
  const auto json = teleoperation_json({row("a", 1e-3, std::nan(""))});
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0].at("architecture"), "a");
  EXPECT_EQ(json[0].at("passivity").at("follower_minimum_J"), 0.0);
  EXPECT_EQ(json[0].at("passivity").at("leader_minimum_J"), 0.0);
  EXPECT_TRUE(json[0].at("force_error_rms_N").is_null());
}

TEST(TeleoperationResults, OfLurchesTheLargestCounts) {
  auto rows = std::vector{row("a", 1e-3, 2), row("a", 1e-3, 2), row("a", 1e-3, 2)};
  rows[1].measures.lurch_m_per_s = 0.05;
  EXPECT_EQ(groups_of(rows)[0].median.lurch_m_per_s, 0.05);
}

TEST(LurchMeter, CountsFromWhenTheLawWithheldUntilTheToolHasCaughtUp) {
  LurchMeter meter(1);
  const auto excess = [&](double leader_m_per_s, double tool_m_per_s, double lag_m, bool withheld) {
    meter.add({.leader_m_per_s = leader_m_per_s, .tool_m_per_s = tool_m_per_s, .lag_m = lag_m, .withheld = withheld});
    return meter.excess_m_per_s();
  };
  EXPECT_EQ(excess(0, 1, 5e-3, false), 0) << "nothing was withheld";
  EXPECT_EQ(excess(0.1, 0, 5e-3, true), 0);
  EXPECT_EQ(excess(0.05, 0.1, 5e-3, false), 0) << "as fast as the leader was";
  EXPECT_NEAR(excess(0.05, 0.11, 5e-3, false), 0.01, 1e-12) << "faster";
  EXPECT_NEAR(excess(0, 0.06, 5e-3, false), 0.04, 1e-12) << "it stands: 20 mm/s";
  EXPECT_NEAR(excess(0, 0.06, 5e-4, false), 0.04, 1e-12);
  EXPECT_NEAR(excess(0, 1, 5e-3, false), 0.04, 1e-12) << "it had caught up";
}

TEST(LurchMeter, ALeadersSpeedCountsUntilTheToolCanHaveFollowed) {
  LurchMeter meter(3);
  for (const double leader_m_per_s : {0.1, 0.0, 0.0}) {
    meter.add({.leader_m_per_s = leader_m_per_s, .tool_m_per_s = 0.1, .lag_m = 5e-3, .withheld = true});
  }
  EXPECT_EQ(meter.excess_m_per_s(), 0);
  meter.add({.leader_m_per_s = 0, .tool_m_per_s = 0.1, .lag_m = 5e-3, .withheld = true});
  EXPECT_NEAR(meter.excess_m_per_s(), 0.08, 1e-12);
}

TEST(FreeSpaceStudy, MarksAndCountsWhatMissesItsBound) {
  FreeSpaceRow near{.architecture = "a", .law = "none", .network = "delay 50ms", .delay_s = 0.05};
  near.felt_N_s_per_m[0] = {4.9, 5.1, 0, 0, 88, 0};  // of 10 Hz nothing is wanted
  near.lag_m = {5.2e-3, 4e-3, 4e-3};
  FreeSpaceRow far = near;
  far.delay_s = 0.1;
  const std::string text = free_space_text({near, far});
  EXPECT_NE(text.find("2 of 11 figures"), std::string::npos) << text;
  EXPECT_NE(text.find("5.1!"), std::string::npos) << text;
  EXPECT_NE(text.find("5.2!"), std::string::npos) << text;
  EXPECT_EQ(text.find("88.0!"), std::string::npos) << text;
}

TeleoperationStudy study_of(const std::string& task, const std::string& architecture, const std::string& network) {
  return {.tasks = {task},
          .architectures = {architecture},
          .laws = {"fba-exact"},
          .networks = {network_of(network)},
          .seeds = 1};
}

TEST(Teleoperation, EveryTaskIsPassiveAtBothEndsAndTheFirstTheSameAgain) {
  if (!server::has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  for (const std::string& task : server::task_names()) {
    SCOPED_TRACE(task);
    const auto study = study_of(task, "position-position", "delay 50ms");
    const auto rows = study_teleoperation(study, [](double) {});
    ASSERT_EQ(rows.size(), 1U);
    const TeleoperationMeasures& m = rows[0].measures;
    EXPECT_GE(m.leader_minimum_J, -1e-9);
    EXPECT_GE(m.leader_kept_minimum_J, -1e-9);
    EXPECT_GE(m.follower_minimum_J, -1e-9);
    EXPECT_TRUE(m.succeeded) << m.measure << " of " << m.goal;
    EXPECT_GT(m.received_J, 0.05);
    if (task != server::task_names().front()) continue;
    const auto again = study_teleoperation(study, [](double) {});
    EXPECT_EQ(again[0].measures.received_J, m.received_J) << "same settings, same run";
  }
}

TEST(Teleoperation, FreeSpaceIsFreeWithAStoreAndNotWithout) {
  if (!server::has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  const auto study = study_of("stiff-wall", "position-force", "none");
  auto setup = setup_of(study, "stiff-wall", "position-force", "fba-exact", study.networks.front(), 1);
  EXPECT_LT(std::abs(swing_hand(setup, {.frequency_Hz = 2}).met.N_s_per_m), 1);
  setup.follower.initial_J = 0;
  EXPECT_GT(std::abs(swing_hand(setup, {.frequency_Hz = 2}).met.N_s_per_m), kFeltMost_N_s_per_m);
}

TEST(Teleoperation, WithoutALawTheRobotLeaks) {
  if (!server::has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  auto study = study_of("plug", "position-force", "delay 10ms");
  study.laws = {"none"};
  const TeleoperationMeasures m = study_teleoperation(study, [](double) {}).at(0).measures;
  EXPECT_LT(m.leader_minimum_J, -0.1);
  EXPECT_LT(m.follower_minimum_J, -0.1);
}

TEST(Teleoperation, AKnownWallIsFeltAtOnceAsStiffAndAsRoughAsWithoutANetwork) {
  if (!server::has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  const auto rows = study_touches(study_of("stiff-wall", "model-mediated", "delay 50ms"));
  ASSERT_EQ(rows.size(), 2U);
  const TouchRow& alone = rows[0];
  const TouchRow& afar = rows[1];
  ASSERT_TRUE(afar.first.felt);
  ASSERT_TRUE(afar.second.felt);
  EXPECT_GT(afar.first.felt_after_s, 0.1) << "an unknown wall takes the way there and back";
  EXPECT_LT(afar.second.felt_after_s, 0.005) << "in virtual time";
  EXPECT_NEAR(afar.second.displayed_N_per_m / alone.second.displayed_N_per_m, 1, 0.2);
  EXPECT_NEAR(alone.displayed_friction, 0.3, 0.01) << "the task's";
  EXPECT_NEAR(afar.displayed_friction, alone.displayed_friction, 0.04);
  EXPECT_GE(afar.leader_minimum_J, -1e-9);
  EXPECT_GE(afar.follower_minimum_J, -1e-9);
}

TEST(Teleoperation, FaultsStopTheRobotAndNothingJumps) {
  if (!server::has_simulated_robots()) GTEST_SKIP() << "built without MuJoCo";
  const auto rows = study_faults(study_of("stiff-wall", "position-position", "delay 10ms"));
  ASSERT_GE(rows.size(), 7U);
  for (const FaultRow& fault : rows) {
    SCOPED_TRACE(fault.fault);
    EXPECT_GE(fault.leader_minimum_J, -1e-9);
    EXPECT_GE(fault.follower_minimum_J, -1e-9);
    EXPECT_LT(fault.speed_m_per_s, 0.4);
    EXPECT_LT(fault.contact_N_max, 80);
    // A device whose client stalls lets go of all of its force.
    EXPECT_LT(fault.step_N_per_ms, fault.fault == "client stalls" ? 10 : 3);
    const bool goes_on = fault.fault == "none" || fault.fault == "way down dead" || fault.fault == "hand too deep" ||
                         fault.fault == "readings freeze";
    EXPECT_EQ(std::isfinite(fault.stopping_s), !goes_on);
    EXPECT_EQ(std::isfinite(fault.stopped_s), !goes_on);
    const bool up_is_dead = fault.fault == "way up dead" || fault.fault == "both ways dead";
    if (!up_is_dead) continue;
    EXPECT_NEAR(fault.holding_s, 0.11, 0.015) << "100 ms of silence, and the way";
    EXPECT_NEAR(fault.stopping_s, 0.51, 0.015);
    EXPECT_TRUE(std::isfinite(fault.following_s)) << "it follows again, once both agree";
  }
}

}  // namespace
}  // namespace forcebound::lab
