#include <gmock/gmock.h>

#include <sstream>

#include "forcebound/text/terminal.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// What it printed and wrote.
struct Examined {
  Ran ran;
  nlohmann::json found;
  int times = 1;  ///< that it took
};

/// @param words further options
Examined examined(const std::string& server, const Words& words) {
  const TemporaryFolder folder;
  Words all{"doctor", "--server", server, "--json", folder.file("found.json")};
  all.insert(all.end(), words.begin(), words.end());
  Examined result{.ran = run(kForcebound, all), .found = {}};
  result.found = nlohmann::json::parse(content(folder.file("found.json")), nullptr, false);
  return result;
}

/// Again where a machine that gave a program no time has delayed the answers to the largest datagrams.
Examined examined_whole(const std::string& server, const Words& words) {
  constexpr int kTimesMost = 4;
  for (int times = 1;; ++times) {
    Examined result = examined(server, words);
    result.times = times;
    const bool done = !result.found.is_object() || result.found["path"]["up_payload_bytes"] == 1200;
    if (done || times == kTimesMost) return result;
  }
}

TEST(Doctor, ExaminesTheWayToARealServerAndThisMachine) {
  Server server({"--scene", "sphere"});
  const Examined here = examined_whole(server.address(), {"--seconds", "1"});
  ASSERT_EQ(here.ran.exit_code, 0) << here.ran.err;
  EXPECT_EQ(here.ran.err, "");
  std::istringstream lines(here.ran.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(text::columns_of(line), text::kColumns) << line;
  EXPECT_THAT(unwrapped(here.ran.out), AllOf(HasSubstr("scene 'sphere' with 3 degrees of freedom"),
                                             HasSubstr("packets of 1228 bytes arrive whole"),
                                             HasSubstr("What it will feel like"), HasSubstr("The network is ")));

  const nlohmann::json& found = here.found;
  ASSERT_TRUE(found.is_object());
  for (const char* const key : {"server", "seconds", "handshake", "round_trip_ms", "at_server_ms", "up", "down",
                                "unanswered", "longest_gap_ms", "faults", "path", "clocks", "machine", "verdict"}) {
    EXPECT_TRUE(found.contains(key)) << key;
  }
  EXPECT_EQ(found["handshake"]["scene"], "sphere");
  EXPECT_EQ(found["handshake"]["server_parts"], "none") << "all of a sphere runs at the client";
  EXPECT_GT(found["handshake"]["piece_bytes"].get<int>(), 0);
  EXPECT_GT(found["up"]["sent"].get<int>(), 0);
  EXPECT_EQ(found["up"]["duplicated"], 0);
  EXPECT_LE(found["round_trip_ms"]["p50"].get<double>(), found["round_trip_ms"]["p99"].get<double>());
  EXPECT_LE(found["round_trip_ms"]["p99"].get<double>(), found["round_trip_ms"]["max"].get<double>());
  EXPECT_EQ(found["path"]["up_payload_bytes"], 1200);
  EXPECT_GE(found["path"]["mtu_bytes"].get<int>(), 1228);
  EXPECT_FALSE(found["clocks"]["server_ahead_ms"].is_null());
  EXPECT_GT(found["machine"]["tick_us"]["wake_ups"].get<int>(), 0);
  EXPECT_GT(found["machine"]["idle_timer_us"]["wake_ups"].get<int>(), 0);
  EXPECT_NE(found["machine"]["granted"], "");
  EXPECT_EQ(found["verdict"]["felt"].size(), 4U);

  EXPECT_EQ(server.stop(), 0);
  const auto sessions = 2U * static_cast<unsigned>(here.times);
  EXPECT_EQ(counted(server.out(), "sessions", "opened"), sessions) << "one to measure, one for the sizes of datagrams";
  EXPECT_EQ(counted(server.out(), "sessions", "ended by the client"), sessions);
}

//   doctor ==( 20 ms each way; 20 % lost up, none down )== server
TEST(Doctor, FindsTheDelayOfARelayAndOnWhichWayItLoses) {
  Server server({"--scene", "sphere"});
  Relay relay(server.address(), {"--netem-up", "delay 20ms loss 20%", "--netem-down", "delay 20ms", "--seed", "7"});
  const Examined far = examined_whole(relay.address(), {"--seconds", "3"});
  ASSERT_EQ(far.ran.exit_code, 0) << far.ran.err;
  ASSERT_TRUE(far.found.is_object());
  // No machine is faster than the delay, and a slow one sends fewer motions.
  EXPECT_GE(far.found["round_trip_ms"]["p50"].get<double>(), 39.5);
  EXPECT_GE(far.found["handshake"]["took_ms"].get<double>(), 39.5);
  EXPECT_GT(far.found["up"]["lost"].get<int>(), 0);
  EXPECT_GT(far.found["up"]["loss"].get<double>(), far.found["down"]["loss"].get<double>());
  EXPECT_EQ(far.found["path"]["up_payload_bytes"], 1200) << "each size is tried more than once";
  bool advised = false;
  for (const auto& change : far.found["verdict"]["changes"])
    advised = advised || change["change"].get<std::string>().find("to the server are lost") != std::string::npos;
  EXPECT_TRUE(advised) << far.ran.out;
  EXPECT_THAT(far.ran.out, HasSubstr("What to change first"));
}

TEST(Doctor, TakesTheDegreesOfFreedomOfTheScene) {
  Server server({"--scene", "circle"});
  const Examined flat = examined(server.address(), {"--seconds", "0.3"});
  ASSERT_EQ(flat.ran.exit_code, 0) << flat.ran.err;
  EXPECT_EQ(flat.found["handshake"]["degrees_of_freedom"], 2);
  EXPECT_EQ(flat.found["handshake"]["scene"], "circle");
}

TEST(Doctor, PassesOnWhyTheServerRefuses) {
  Server server({"--scene", "sphere"});
  const Examined refused = examined(server.address(), {"--scene", "spere", "--seconds", "0.3"});
  EXPECT_EQ(refused.ran.exit_code, 1);
  EXPECT_EQ(refused.ran.out, "");
  EXPECT_EQ(lines(refused.ran.err), 1U) << refused.ran.err;
  EXPECT_THAT(refused.ran.err, AllOf(HasSubstr("refused: "), HasSubstr("'spere'"), HasSubstr("'sphere'")));
}

TEST(Doctor, FailsWithoutAServer) {
  const Ran doctor = run(kForcebound, {"doctor", "--server", free_address(), "--seconds", "0.3"});
  EXPECT_EQ(doctor.exit_code, 1);
  EXPECT_EQ(doctor.out, "");
  EXPECT_EQ(lines(doctor.err), 1U) << doctor.err;
  EXPECT_THAT(doctor.err, AllOf(HasSubstr("no answer from 127.0.0.1:"), HasSubstr("port unreachable (ICMP)")));
}

}  // namespace
}  // namespace forcebound::test
