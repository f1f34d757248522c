#include <gmock/gmock.h>

#include <regex>
#include <sstream>

#include "tests/process/programs.hpp"
#include "tests/process/recorded_run.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

class ASignal : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Of, ASignal, testing::Values(SIGINT, SIGTERM),
                         [](const auto& signal) { return signal.param == SIGINT ? "Interruption" : "Termination"; });

TEST_P(ASignal, EndsEveryProgramCleanlyWithAllThatItKnows) {
  const TemporaryFolder folder;
  Server server({"--scene", "sphere"});
  Relay relay(server.address(), {"--netem", "delay 5ms", "--log", folder.file("log.csv")});
  RecordedClient client(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--law", "fba-more"});
  ASSERT_TRUE(client.wait_for_tick(is_answered));

  const std::optional<int> ended = client.stop(GetParam());
  EXPECT_EQ(ended, client.expected_end());
  EXPECT_THAT(client.out(), AllOf(HasSubstr("law           fba-more"), HasSubstr("least P")));
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_EQ(summary["complete"], true);
  EXPECT_GT(summary["received"], 0);
  EXPECT_EQ(summary["lost"], 0);

  EXPECT_EQ(relay.stop(GetParam()), 0);
  EXPECT_THAT(relay.out(), AllOf(testing::ContainsRegex("datagrams +up +down\n *received +[0-9]+ +[0-9]+\n"),
                                 HasSubstr("clients: 1 seen")));
  const std::string log = content(folder.file("log.csv"));
  EXPECT_THAT(relay.out(), HasSubstr("log: " + std::to_string(lines(log) - 1) + " rows in"));

  EXPECT_EQ(server.stop(GetParam()), 0);
  EXPECT_EQ(counted(server.out(), "sessions", "ended by the client"), 1U);
  EXPECT_EQ(counted(server.out(), "motions", "received"), summary["sent"].get<std::uint64_t>());
}

TEST_P(ASignal, EndsAClientThatHasNoServer) {
  Client client(free_address(), {});
  ASSERT_TRUE(client.wait_for("no answer from"));
  const auto ended = client.stop(GetParam());
  EXPECT_EQ(ended, client.expected_end());
  EXPECT_EQ(client.summary()["complete"], true);
}

/// Each line of a log begins with the time, the program and the level: an event is never spread over lines.
void expect_log_lines_of(const char* program, const std::string& log) {
  EXPECT_FALSE(log.empty()) << program;
  const std::regex pattern(R"(\d\d:\d\d:\d\d\.\d{3} )" + std::string(program) + " (info|warning|error): .*");
  std::istringstream in(log);
  for (std::string line; std::getline(in, line);) EXPECT_TRUE(std::regex_match(line, pattern)) << line;
}

TEST(EveryProgram, LogsAnEventALineInOnePattern) {
  Server server({"--scene", "microsurgery"});                 // of which there is more to say than fits a terminal
  Relay relay(server.address(), {"--netem", "loss 5% 50%"});  // which it warns of
  Client client(relay.address(), {"--device", "omni", "--duration", "1", "--once"});
  EXPECT_EQ(client.wait(20s), 0);
  EXPECT_EQ(relay.stop(), 0);
  EXPECT_EQ(server.stop(), 0);
  expect_log_lines_of("forcebound-client", client.err());
  expect_log_lines_of("forcebound-relay", relay.err());
  expect_log_lines_of("forcebound-server", server.err());
}

TEST(TheClient, LogsAtItsStartWhichSchedulingItWasGranted) {
  Client client(free_address(), {});
  ASSERT_TRUE(client.wait_for("tick thread: "));
  EXPECT_THAT(client.err(), testing::ContainsRegex("tick thread: (no )?SCHED_FIFO"));
  const auto ended = client.stop();
  EXPECT_EQ(ended, client.expected_end());
  EXPECT_EQ(client.err().find("tick thread: "), client.err().rfind("tick thread: ")) << "once";
}

// client without a law --- relay, 20 ms each way --- server with a wall: the force is late enough to give energy.
TEST(AClient, ThatWasNotPassiveSaysSoByItsExitCode) {
  Server server({"--scene", "wall"});
  Relay relay(server.address(), {"--netem", "delay 20ms"});
  Client client(relay.address(), {"--device", "wall-1dof", "--operator", "press", "--law", "none", "--rendering",
                                  "remote", "--duration", "4", "--once"});
  EXPECT_EQ(client.wait(30s), 3);
  EXPECT_EQ(client.summary()["verdict"], "not passive");
  EXPECT_THAT(client.out(), testing::StartsWith("Summary: NOT PASSIVE"));
}

}  // namespace
}  // namespace forcebound::test
