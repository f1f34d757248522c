#include "forcebound/record/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::record {
namespace {

using nlohmann::json;
using record::test::vector_of;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

json json_of(const Summary& summary) { return json::parse(summary.to_json()); }

/// One axis; tick n at n ms.
TickRecord tick_at(std::uint64_t n) {
  TickRecord tick;
  tick.tick = n;
  tick.time = Nanoseconds{static_cast<std::int64_t>(n) * 1'000'000};
  tick.interval = Nanoseconds{1'000'000};
  tick.position = tick.joint = tick.request = tick.applied = vector_of({0});
  return tick;
}

TickRecord contact_at(std::uint64_t n, double force_N, double penetration_m) {
  TickRecord tick = tick_at(n);
  tick.request = tick.applied = vector_of({-force_N});
  tick.displayed_N = force_N;
  tick.penetration_m = penetration_m;
  tick.contact = !(penetration_m <= 0);
  return tick;
}

ForceRecord force_at(std::uint64_t n, std::uint64_t answers) {
  ForceRecord force;
  force.receive_time = Nanoseconds{static_cast<std::int64_t>(n) * 1'000'000};
  force.force.sequence = force.force.motion_sequence = answers;
  return force;
}

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

RunInfo audited() {
  RunInfo info;
  info.audited = true;
  return info;
}

TickRecord connected(TickRecord tick) {
  tick.state = SessionState::active;
  return tick;
}

TEST(Summary, CallsPassiveOnlyWhatNeverFellBelowTheRounding) {
  for (const auto& [minimum, ok] : {std::pair{0.0, true}, {-0.9e-9, true}, {-1.1e-9, false}, {-0.004, false}}) {
    Summary summary(audited());
    TickRecord tick = connected(contact_at(1, 1, 1e-3));
    tick.audit_minimum_J = minimum;
    summary.on_tick(tick);
    tick.audit_minimum_J = 0;  // a later tick does not undo it
    summary.on_tick(tick);
    const json passivity = json_of(summary)["passivity"];
    EXPECT_EQ(passivity["ok"], ok) << minimum;
    EXPECT_EQ(passivity["minimum_J"], minimum);
    EXPECT_THAT(summary.to_text(), StartsWith(ok ? "Summary: passive; " : "Summary: NOT PASSIVE; ")) << minimum;
  }
}

TEST(Summary, NeverTakesAnAuditThatIsNotANumberForPassive) {
  Summary summary(audited());
  TickRecord tick = tick_at(1);
  tick.audit_minimum_J = std::numeric_limits<double>::quiet_NaN();
  summary.on_tick(tick);
  summary.on_tick(tick_at(2));
  const json object = json_of(summary);
  EXPECT_TRUE(object["passivity"]["minimum_J"].is_null());
  EXPECT_EQ(object["passivity"]["ok"], false);
  EXPECT_EQ(object["verdict"], "not passive");
}

TEST(Summary, DoesNotJudgeADeviceWithoutAudit) {
  RunInfo info;
  info.law = "fba-exact";
  info.guarantee = "P >= 0 as long as its damping is as said";
  Summary summary(info);
  summary.on_tick(connected(contact_at(1, 1, 1e-3)));
  const json object = json_of(summary);
  EXPECT_EQ(object["verdict"], "not audited");
  EXPECT_TRUE(object["passivity"]["ok"].is_null());
  EXPECT_TRUE(object["passivity"]["minimum_J"].is_null());
  EXPECT_EQ(object["passivity"]["guarantee"], info.guarantee);
  const std::string text = summary.to_text();
  EXPECT_THAT(text, StartsWith("Summary: not audited; "));
  EXPECT_THAT(text, HasSubstr("not audited: this device does not measure P"));
  EXPECT_THAT(text, Not(HasSubstr("least P")));
  EXPECT_THAT(text, Not(HasSubstr(": passive")));
}

TEST(Summary, HasNoVerdictOfARunThatTouchedNothing) {
  Summary summary(audited());
  for (std::uint64_t n = 1; n <= 10; ++n) summary.on_tick(connected(tick_at(n)));
  const json object = json_of(summary);
  EXPECT_EQ(object["verdict"], "no contact");
  EXPECT_TRUE(object["passivity"]["ok"].is_null());
  EXPECT_THAT(summary.to_text(), StartsWith("Summary: no contact, no verdict; "));
}

TEST(Summary, HasAVerdictForForcesWithoutASurface) {
  Summary summary(audited());
  TickRecord tick = connected(tick_at(1));
  tick.request = tick.applied = vector_of({1});
  summary.on_tick(tick);
  EXPECT_EQ(json_of(summary)["verdict"], "passive");
}

TEST(Summary, HasNoVerdictOfARunThatNeverConnected) {
  Summary summary(audited());
  for (std::uint64_t n = 1; n <= 10; ++n) summary.on_tick(tick_at(n));
  const json object = json_of(summary);
  EXPECT_EQ(object["verdict"], "never connected");
  EXPECT_TRUE(object["passivity"]["ok"].is_null());
  EXPECT_THAT(summary.to_text(), StartsWith("Summary: never connected, no verdict; "));
}

TEST(Summary, SaysFirstThatARecordingIsIncomplete) {
  for (std::uint64_t RunTotals::*count : {&RunTotals::recording_dropped, &RunTotals::recording_unwritten}) {
    Summary summary(audited());
    TickRecord tick = connected(contact_at(1, 1, 1e-3));
    tick.audit_minimum_J = -1;
    summary.on_tick(tick);
    RunTotals totals;
    totals.*count = 1;
    summary.finish(totals);
    EXPECT_THAT(summary.to_text(), StartsWith("Summary: NOT PASSIVE, RECORDING INCOMPLETE; "));
    EXPECT_THAT(summary.to_text(), HasSubstr("1 record missing"));
  }
}

TEST(Summary, SaysWhetherTheDeviceIsSimulated) {
  RunInfo info = test::sample_info();
  EXPECT_THAT(Summary(info).to_text(), HasSubstr("device        simulated, wall-1dof"));
  EXPECT_EQ(json_of(Summary(info))["run"]["device_simulated"], true);
  info.device_simulated = false;
  EXPECT_THAT(Summary(info).to_text(), HasSubstr("device        wall-1dof"));
  EXPECT_EQ(json_of(Summary(info))["run"]["device_simulated"], false);
}

TEST(Summary, SaysHowDatagramsWereEncryptedUnlessTheRecordingDoesNot) {
  RunInfo info = test::sample_info();
  EXPECT_THAT(Summary(info).to_text(), HasSubstr("encryption    IKpsk2\n"));
  EXPECT_EQ(json_of(Summary(info))["encryption"], "IKpsk2");
  info.encryption = "none";
  EXPECT_THAT(Summary(info).to_text(), HasSubstr("encryption    none\n"));
  EXPECT_EQ(json_of(Summary(info))["encryption"], "none");
  info.encryption.clear();
  EXPECT_THAT(Summary(info).to_text(), Not(HasSubstr("encryption")));
  EXPECT_EQ(json_of(Summary(info))["encryption"], nullptr);
}

TEST(Summary, ShowsANegativePInRedWhereColoursAreWanted) {
  Summary summary(audited());
  TickRecord tick = connected(contact_at(1, 1, 1e-3));
  tick.audit_minimum_J = -0.25;
  summary.on_tick(tick);
  EXPECT_THAT(summary.to_text(text::Colour::ansi), HasSubstr("least P \033[31m-250 mJ\033[0m, final"));
  EXPECT_THAT(summary.to_text(), Not(HasSubstr("\033")));
}

TEST(Summary, NamesTheUnknownCountsOfAnIncompleteRun) {
  Summary summary(test::sample_info());
  test::play_sample_run(summary, 100);
  const json object = json_of(summary);
  EXPECT_EQ(object["complete"], false);
  EXPECT_TRUE(object["lost"].is_null());
  EXPECT_EQ(object["sent"], 100);
  EXPECT_EQ(object["received"], 91);
  EXPECT_THAT(summary.to_text(), HasSubstr("the recording ends before the totals"));
}

TEST(Summary, IsReadableAfterAnEmptyRun) {
  Summary summary(RunInfo{});
  const json object = json_of(summary);
  EXPECT_EQ(object["ticks"], 0);
  EXPECT_TRUE(object["force_N"]["mean"].is_null());
  EXPECT_TRUE(object["bounded_fraction"].is_null());
  EXPECT_FALSE(summary.to_text().empty());
}

TEST(Summary, SaysHowFarTheServersClockIsAheadAndByHowMuchThatMayBeOff) {
  Summary summary(test::sample_info());
  RunTotals totals = test::sample_totals();
  totals.server_ahead = Nanoseconds{-2'500'000};
  totals.server_ahead_off = Nanoseconds{10'000'000};
  Summary unknown(test::sample_info());
  unknown.finish(RunTotals{});
  EXPECT_TRUE(json_of(unknown)["server_clock_ms"].is_null());
  summary.finish(totals);
  EXPECT_DOUBLE_EQ(json_of(summary)["server_clock_ms"]["ahead"].get<double>(), -2.5);
  EXPECT_DOUBLE_EQ(json_of(summary)["server_clock_ms"]["off"].get<double>(), 10);
  totals.server_ahead_off = Nanoseconds::zero();
  Summary exact(test::sample_info());
  exact.finish(totals);
  EXPECT_DOUBLE_EQ(json_of(exact)["server_clock_ms"]["off"].get<double>(), 0);
}

TEST(Summary, SaysOnWhatShareOfTheTicksForcesWereComputedWhere) {
  RunInfo info = test::sample_info();
  info.rendering = "local";
  Summary summary(info);
  for (std::uint64_t n = 1; n <= 10; ++n) {
    TickRecord tick = tick_at(n);
    if (n > 4) tick.rendering = ForceOrigin::at_client;
    if (n > 9) tick.rendering = ForceOrigin::both;
    if (n > 7) tick.model = vector_of({1});
    if (n > 6) tick.model_trust = n > 7 ? 1 : 0;
    summary.on_tick(tick);
  }
  summary.finish(test::sample_totals());
  const json rendering = json_of(summary)["rendering"];
  EXPECT_EQ(rendering["asked"], "local");
  EXPECT_EQ(rendering["held"], 0.4);
  EXPECT_EQ(rendering["at_client"], 0.5);
  EXPECT_EQ(rendering["both"], 0.1);
  EXPECT_EQ(rendering["modelled"], 0.3);
  EXPECT_EQ(rendering["model_trust"], 0.75) << "of the ticks with models";
  EXPECT_THAT(summary.to_text(),
              HasSubstr("  rendering     local: 50 % of the ticks at the client, 10 % both, 40 % held;\n"
                        "                local models on 30 %, trust in them 75 %\n"));
}

TEST(Summary, SaysNothingOfTrustWhereNoModelCame) {
  RunInfo info = test::sample_info();
  info.rendering = "local";
  Summary summary(info);
  summary.on_tick(tick_at(1));
  EXPECT_TRUE(json_of(summary)["rendering"]["model_trust"].is_null());
  EXPECT_THAT(summary.to_text(),
              HasSubstr("rendering     local: 0 % of the ticks at the client, 0 % both, 100 % held\n"));
}

TEST(Summary, SaysThatForcesWereRenderedRemotely) {
  EXPECT_THAT(Summary(test::sample_info()).to_text(), HasSubstr("rendering     remote: all forces are the server's\n"));
}

TEST(Summary, SurvivesTextThatIsNotUtf8AndLongerThanALine) {
  RunInfo info;
  info.device = "\xff\xfe";
  info.law = std::string(5000, 'l');
  info.simulated = std::string(5000, 's');
  const Summary summary(info);
  EXPECT_NO_THROW(json_of(summary));
  EXPECT_THAT(summary.to_text(), HasSubstr(info.simulated));
}

TEST(Summary, FitsOneScreenAndNamesEachFault) {
  RunInfo info = test::sample_info();
  info.facts =
      "wall-1dof: 1 degree of freedom, Cartesian, mass 0.08 kg, damping 30 N s/m, friction 0 N, encoder 1.5e-05 "
      "m, force <= 30 N, hold 0.001 s, latency 0 s";
  Summary summary(info);
  test::play_sample_run(summary, 3000);
  summary.finish(test::sample_totals());
  const std::string text = summary.to_text();
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 30);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), text::kColumns) << line;
  EXPECT_THAT(text, HasSubstr("2 datagrams whose checksum disagrees"));
  EXPECT_THAT(text, HasSubstr("server restarted at 1.234 s"));
  EXPECT_THAT(text, Not(ContainsRegex("[^a-z]nan[^a-z]")));
}

TEST(Summary, AddingDoesNotAllocate) {
  if (!forcebound::time::kCountsHeapOperations) GTEST_SKIP() << "allocations are not counted under sanitizers";
  Summary summary(test::sample_info());
  const auto before = forcebound::time::heap_operations_of_this_thread();
  test::play_sample_run(summary, 2000);
  EXPECT_EQ(forcebound::time::heap_operations_of_this_thread(), before);
}

TEST(Summary, ShowsNoControlCharactersOfARecording) {
  RunInfo info = test::sample_info();
  info.law = "\x1b[2Jlaw";
  info.device = "device\nSummary: passive";
  info.scene = "\x9b" + std::string("31m");
  Summary summary(info);
  RunTotals totals;
  totals.notes = {"a note\x07"};
  summary.finish(totals);
  const std::string text = summary.to_text();
  EXPECT_EQ(text.find_first_of("\x1b\x07\x9b"), std::string::npos) << text;
  EXPECT_EQ(text.find("\nSummary: passive"), std::string::npos) << text;
  EXPECT_THAT(text, HasSubstr("?[2Jlaw"));
}

TEST(Summary, TellsHowLongARobotWasInWhichState) {
  using enum control::FollowerState;
  Summary summary(test::sample_info());
  const auto answer = [&summary](std::uint64_t n, control::FollowerState state) {
    ForceRecord force = force_at(n, n);
    force.force.answer.follower = state;
    summary.on_force(force);
  };
  for (std::uint64_t n = 1; n <= 50; ++n) answer(n, waiting);
  for (std::uint64_t n = 51; n <= 250; ++n) answer(n, following);
  answer(1250, stopped);  // after a second without answers
  answer(1300, stopped);
  ForceRecord late = force_at(1310, 60);
  late.force.answer.follower = following;
  summary.on_force(late);
  const json follower = json_of(summary)["follower"];
  EXPECT_EQ(follower["state"], "stopped") << "an answer that was overtaken tells nothing new";
  EXPECT_EQ(follower["changes"], 2);
  EXPECT_NEAR(follower["seconds"]["waiting"].get<double>(), 0.05, 1e-9);
  EXPECT_NEAR(follower["seconds"]["following"].get<double>(), 0.199 + 0.1, 1e-9);
  EXPECT_NEAR(follower["seconds"]["stopped"].get<double>(), 0.05, 1e-9);
  EXPECT_EQ(follower["seconds"]["holding"], 0);
  EXPECT_NEAR(follower["unknown_s"].get<double>(), 0.9, 1e-9);
  EXPECT_THAT(summary.to_text(), HasSubstr("waiting 0.05 s, following 0.299 s, stopped 0.05 s"));
}

TEST(Summary, SaysNothingOfARobotWhereThereIsNone) {
  Summary summary(test::sample_info());
  summary.on_force(force_at(1, 1));
  EXPECT_TRUE(json_of(summary)["follower"].is_null());
  EXPECT_THAT(summary.to_text(), Not(HasSubstr("robot")));
}

}  // namespace
}  // namespace forcebound::record
