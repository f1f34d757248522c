#include <gmock/gmock.h>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kOutputLost = 4;
constexpr const char* kFull = "/dev/full";  // every write finds no space left

TEST(AFileThatCannotBeCreated, IsRefusedBeforeAnythingStarts) {
  const std::string file = "/no/such/folder/file";
  const std::string address = free_address();
  const Words client{"--server", address, "--duration", "30"};
  struct Case {
    const char* program;
    Words arguments;
  };
  for (const Case& c : {Case{kClient, {"--server", address, "--duration", "30", "--record", file}},
                        Case{kClient, {"--server", address, "--duration", "30", "--summary", file}},
                        Case{kRelay, {"--listen", "127.0.0.1:0", "--upstream", address, "--log", file}}}) {
    const Ran ran = run(c.program, c.arguments, 10s);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(lines(ran.err), 1U) << ran.err;
    EXPECT_THAT(ran.err, AllOf(HasSubstr(file), HasSubstr("No such file or directory")));
    EXPECT_EQ(ran.out, "");
  }
}

TEST(TheLab, RefusesAFileThatCannotBeCreatedBeforeItsWork) {
  const std::string file = "/no/such/folder/file";
  const std::string png = file + ".png";
  const Words compare{"compare", "--laws", "none", "--scenes", "wall", "--network", "none", "--no-limits"};
  const auto with = [](Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  for (const Words& words :
       {Words{"accuracy", "sphere", "--json", file}, Words{"accuracy", "sphere", "--levels", file},
        Words{"accuracy", "sphere", "--readme", file}, Words{"accuracy", "sphere", "--figures", "/dev/null"},
        with(compare, {"--readme", file}), with(compare, {"--figures", "/dev/null"}),
        Words{"passivity", "--figure", png}, Words{"reproduce", "--figures", "/dev/null"},
        Words{"trials", "--json", file}, Words{"trials", "--figure", png}}) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Ran ran = run(kLab, words, 20s);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(lines(ran.err), 1U) << ran.err;
    EXPECT_THAT(ran.err, testing::AnyOf(HasSubstr(file), HasSubstr("'/dev/null'")));
    EXPECT_EQ(ran.out, "");
  }
}

TEST(ASummary, OfTheRunBeforeStaysWhereARunCannotStart) {
  const TemporaryFolder folder;
  write_file(folder.file("summary.json"), "last results");
  const Ran ran = run(
      kClient,
      {"--server", free_address(), "--summary", folder.file("summary.json"), "--record", "/no/such/folder/file"}, 10s);
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(content(folder.file("summary.json")), "last results");
}

TEST(AFullDisk, EndsTheRecordingButNotTheRun) {
  Server server({"--scene", "sphere"});
  Client client(server.address(),
                {"--device", "omni", "--operator", "trace-sphere", "--duration", "3", "--record", kFull});
  EXPECT_TRUE(client.wait_for("No space left on device; the run goes on")) << "told before the end";
  EXPECT_EQ(client.wait(20s), kOutputLost);
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_GT(summary["ticks"], 0);
  EXPECT_EQ(summary["lost"], 0);
  // Each tick and each force.
  EXPECT_EQ(summary["faults"]["recording_unwritten"].get<int>(),
            summary["ticks"].get<int>() + summary["received"].get<int>());
  EXPECT_THAT(summary["faults"]["notes"].dump(), AllOf(HasSubstr("/dev/full"), HasSubstr("No space left on device")));
  EXPECT_THAT(client.out(), testing::StartsWith("Summary: passive, RECORDING INCOMPLETE; "));
}

TEST(AFullDisk, IsNamedWhereTheSummaryCouldNotBeWritten) {
  const Ran ran = run(kClient, {"--server", free_address(), "--duration", "1", "--summary", kFull});
  EXPECT_EQ(ran.exit_code, kOutputLost);
  EXPECT_THAT(ran.out, HasSubstr("Summary: never connected, no verdict"));
  EXPECT_THAT(ran.err, HasSubstr("/dev/full: cannot be written: No space left on device"));
}

TEST(AFullDisk, EndsTheServersRecordingButNotTheServer) {
  Server server({"--scene", "sphere", "--record", kFull});
  Client client(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "2", "--once"});
  EXPECT_TRUE(server.wait_for("No space left on device; the server goes on")) << "told before the end";
  EXPECT_EQ(client.wait(20s), 0);
  EXPECT_GT(client.summary()["received"], 0);
  EXPECT_EQ(server.stop(), kOutputLost);
}

TEST(AFullDisk, EndsTheRelaysLogButNotTheRelay) {
  Server server({"--scene", "sphere"});
  Relay relay(server.address(), {"--log", kFull});
  Client client(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "2", "--once"});
  EXPECT_EQ(client.wait(20s), 0);
  EXPECT_EQ(client.summary()["lost"], 0);
  EXPECT_GT(client.summary()["received"], 0);
  EXPECT_TRUE(relay.wait_for("is incomplete: No space left on device; the relay goes on"));
  EXPECT_EQ(relay.stop(), kOutputLost);
  EXPECT_THAT(relay.out(), HasSubstr("rows missing: No space left on device"));
}

}  // namespace
}  // namespace forcebound::test
