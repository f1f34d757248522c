#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "tests/process/programs.hpp"
#include "tests/process/recorded_run.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kNodeModulesMissing = 77;  // mcap_core/check.mjs says so

/// A client's run through a network with some loss, recorded to `file`.
std::unique_ptr<Client> record_run(const std::string& file, const std::string& rendering = "remote") {
  Server server({"--scene", "sphere"});
  Relay relay(server.address(), {"--netem", "delay 10ms 5ms loss 2%", "--seed", "3"});
  auto client =
      std::make_unique<Client>(relay.address(), Words{"--device", "omni", "--operator", "trace-sphere", "--duration",
                                                      "3", "--record", file, "--rendering", rendering});
  EXPECT_EQ(client->wait(30s), 0);
  return client;
}

TEST(ARecording, GivesTheClientsSummaryAgainByteForByteAndItsFigure) {
  const TemporaryFolder folder;
  const std::string recording = folder.file("run.mcap");
  const auto client = record_run(recording);
  const Ran report = run(
      kForcebound, {"report", recording, "--json", folder.file("report.json"), "--figures", folder.file("figures")});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_EQ(report.err, "");
  EXPECT_EQ(content(folder.file("report.json")), client->summary_text());
  EXPECT_THAT(report.out, StartsWith(client->out()));

  const std::string figure = folder.file("figures/run.png");
  EXPECT_THAT(content(figure), StartsWith("\x89PNG\r\n\x1a\n"));
  EXPECT_GT(content(figure).size(), 10'000U);
  EXPECT_THAT(report.out, HasSubstr("figure " + figure));
}

TEST(ARecording, OfLocalRenderingGivesTheSummaryAgainToo) {
  const TemporaryFolder folder;
  const std::string recording = folder.file("run.mcap");
  const auto client = record_run(recording, "local");
  EXPECT_GT(client->summary()["rendering"]["at_client"].get<double>(), 0);
  const Ran report = run(kForcebound, {"report", recording, "--json", folder.file("report.json")});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_EQ(content(folder.file("report.json")), client->summary_text());
  EXPECT_THAT(report.out, StartsWith(client->out()));
}

TEST(ARecording, GivesEveryTickToTheOfficialReader) {
  const std::string node = FORCEBOUND_NODE;
  if (node.empty()) GTEST_SKIP() << "node is not installed (Debian: apt-get install nodejs npm)";
  const TemporaryFolder folder;
  const std::string recording = folder.file("run.mcap");
  write_file(folder.file("summary.json"), record_run(recording)->summary_text());
  setenv("FORCEBOUND_NODE_MODULES", FORCEBOUND_MCAP_PACKAGES, 0);
  const Ran check = run(node.c_str(), {FORCEBOUND_MCAP_CHECK, recording, "--summary", folder.file("summary.json")});
  if (check.exit_code == kNodeModulesMissing) GTEST_SKIP() << check.out;
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, HasSubstr("the official reader finds every tick: "));
}

/// Recordings of both ends of a run on a scene.
struct BothRecordings {
  TemporaryFolder folder;
  std::string client = folder.file("client.mcap");
  std::string server = folder.file("server.mcap");

  BothRecordings() {
    Server serving({"--scene", "sphere", "--record", server});
    Relay relay(serving.address(), {"--netem-up", "loss 5%", "--netem-down", "loss 10%", "--seed", "3"});
    Client running(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "3", "--record",
                                     client, "--rendering", "local"});
    EXPECT_EQ(running.wait(30s), 0);
    serving.stop(SIGINT);
  }
};

TEST(ARecording, ShowsItsRunInFoxglovesPanel) {
  const std::string node = FORCEBOUND_NODE;
  if (node.empty()) GTEST_SKIP() << "node is not installed (Debian: apt-get install nodejs npm)";
  const BothRecordings both;
  setenv("FORCEBOUND_NODE_MODULES", FORCEBOUND_MCAP_PACKAGES, 0);
  const Ran client = run(node.c_str(), {FORCEBOUND_FOXGLOVE_CHECK, both.client});
  if (client.exit_code == kNodeModulesMissing) GTEST_SKIP() << client.out;
  EXPECT_EQ(client.exit_code, 0) << client.out << client.err;
  EXPECT_THAT(client.out, HasSubstr("attached: device.toml, law.toml, scene.json"));
  EXPECT_THAT(client.out, HasSubstr("what the 3D panel shows is there: "));
  const Ran server = run(node.c_str(), {FORCEBOUND_FOXGLOVE_CHECK, both.server, "--server"});
  EXPECT_EQ(server.exit_code, 0) << server.out << server.err;
  EXPECT_THAT(server.out, HasSubstr("attached: sphere.toml"));
}

TEST(ARecording, OfAClientAndOfItsServerAreReportedTogetherInEitherOrder) {
  const BothRecordings both;
  const Ran report = run(kForcebound, {"report", both.client, both.server});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_EQ(report.err, "");
  EXPECT_THAT(report.out, HasSubstr("Both ends: 1 session in both recordings"));
  EXPECT_THAT(report.out, HasSubstr("device.toml ("));
  EXPECT_THAT(report.out, HasSubstr("sphere.toml ("));
  EXPECT_EQ(run(kForcebound, {"report", both.server, both.client}).out, report.out);

  const Ran json = run(kForcebound, {"report", both.client, both.server, "--json", "-"});
  const nlohmann::json results = nlohmann::json::parse(json.out)["both_ends"];
  EXPECT_EQ(results["forces"]["differ"], 0);
  const auto sent = results["motions"]["sent"].get<int>();
  const auto answered = results["motions"]["answered"].get<int>();
  const auto back = results["motions"]["came_back"].get<int>();
  EXPECT_GT(back, 0);
  EXPECT_LT(back, answered);  // 10 % of the answers were lost
  EXPECT_LT(answered, sent);  // and 5 % of the motions
  EXPECT_EQ(results["forces"]["received"], back);
  EXPECT_EQ(results["forces"]["sent"], answered);
  const Ran twice = run(kForcebound, {"report", both.client, both.client});
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_THAT(twice.err, HasSubstr("both are of clients"));
}

TEST(ARecording, OfAKilledClientHasWhatWasWrittenUntilThen) {
  const TemporaryFolder folder;
  Server server({"--scene", "sphere"});
  RecordedClient client(server.address(), {"--device", "omni", "--operator", "trace-sphere"});
  constexpr std::uint64_t kTicks = 3000;
  ASSERT_TRUE(client.wait_for_tick([](const auto& tick) { return tick.tick > kTicks; }));
  client.stop(SIGKILL);
  const std::string recording = client.recording();
  const Ran report = run(kForcebound, {"report", recording, "--json", folder.file("report.json")});
  EXPECT_EQ(report.exit_code, 0);
  EXPECT_THAT(report.err, StartsWith(recording + ": incomplete: it ends at byte "));
  EXPECT_THAT(report.err, EndsWith("; shown is what is whole\n"));
  const nlohmann::json summary = nlohmann::json::parse(content(folder.file("report.json")));
  EXPECT_EQ(summary["complete"], false);
  EXPECT_GE(summary["ticks"], kTicks);
}

}  // namespace
}  // namespace forcebound::test
