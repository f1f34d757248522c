#include "forcebound/record/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "tests/unit/record/sample_ticks.hpp"

namespace forcebound::record {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

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

TEST(Summary, SaysInWordsThatForcesArrivedOfWhichNoTickHadOne) {
  Summary summary(test::sample_info());
  summary.on_force(force_at(1, 1));
  summary.on_tick(tick_at(1));
  EXPECT_THAT(summary.to_text(), HasSubstr("force age     no tick had a force\n"));
  EXPECT_THAT(summary.to_text(), Not(HasSubstr("nan ms")));
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
