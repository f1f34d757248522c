#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "tests/process/programs.hpp"

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
  const Ran report =
      run(kLab, {"report", recording, "--json", folder.file("report.json"), "--figures", folder.file("figures")});
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
  const Ran report = run(kLab, {"report", recording, "--json", folder.file("report.json")});
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

TEST(ARecording, OfAKilledClientLacksAtMostItsLastSecond) {
  const TemporaryFolder folder;
  const std::string recording = folder.file("run.mcap");
  Server server({"--scene", "sphere"});
  Client client(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--record", recording});
  ASSERT_TRUE(client.wait_for("connected"));
  std::this_thread::sleep_for(3500ms);
  client.stop(SIGKILL);
  const Ran report = run(kLab, {"report", recording, "--json", folder.file("report.json")});
  EXPECT_EQ(report.exit_code, 0);
  EXPECT_THAT(report.err, StartsWith(recording + ": incomplete: it ends at byte "));
  EXPECT_THAT(report.err, EndsWith("; shown is what is whole\n"));
  const nlohmann::json summary = nlohmann::json::parse(content(folder.file("report.json")));
  EXPECT_EQ(summary["complete"], false);
  // A tick may be skipped, and records wait 50 ms for the disk.
  EXPECT_GT(summary["duration_s"], 2.3);
  EXPECT_GT(summary["ticks"], 0);
}

}  // namespace
}  // namespace forcebound::test
