#include <gmock/gmock.h>

#include <thread>

#include "tests/process/programs.hpp"

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
  Client client(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--law", "fba-more"});
  ASSERT_TRUE(client.wait_for("connected"));
  std::this_thread::sleep_for(700ms);

  EXPECT_EQ(client.stop(GetParam()), 0);
  EXPECT_THAT(client.out(), AllOf(HasSubstr("law           fba-more"), HasSubstr("P minimum")));
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_EQ(summary["complete"], true);
  EXPECT_GT(summary["received"], 100);
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
  EXPECT_EQ(client.stop(GetParam()), 0);
  EXPECT_EQ(client.summary()["complete"], true);
}

}  // namespace
}  // namespace forcebound::test
