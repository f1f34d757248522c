#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;
using netem::Direction;
using nlohmann::json;
using testing::HasSubstr;

//   omni, trace-sphere -- session ==( 5 ms each way, sometimes dead )== server, sphere
class ABlackoutOfTheNetwork : public ::testing::Test {
 protected:
  ABlackoutOfTheNetwork() { loop.run(1s); }

  void kill(std::initializer_list<Direction> directions, Nanoseconds duration) {
    for (const Direction direction : directions) loop.network().set_blackhole(direction, true);
    loop.run(duration);
    for (const Direction direction : directions) loop.network().set_blackhole(direction, false);
  }

  /// Checks which direction died in the client's summary, after it has recovered.
  void expect_longest(const std::string& died, const std::string& words) {
    loop.run(3s);
    EXPECT_EQ(loop.session().state(), client::SessionState::active);
    expect_longest_at_the_end(died, words);
  }

  void expect_longest_at_the_end(const std::string& died, const std::string& words) {
    const json summary = json::parse(loop.close().to_json());
    longest = summary["blackouts"]["longest"];
    EXPECT_EQ(longest["died"], died) << longest;
    EXPECT_THAT(summary["faults"]["notes"].dump(), HasSubstr(words));
    // Where the line is too long, it goes on in the next.
    EXPECT_THAT(std::regex_replace(loop.close().to_text(), std::regex("\n +"), " "), HasSubstr(words));
    EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -5e-3);
  }

  ClosedLoop loop{{.device = device::load_device("omni"),
                   .hand = "trace-sphere",
                   .law = "fba-less",
                   .scene = server::load_scene("sphere"),
                   .network = {.up = netem::parse_netem("delay 5ms"), .down = netem::parse_netem("delay 5ms")}}};
  json longest;
};

TEST_F(ABlackoutOfTheNetwork, NamesTheDirectionDownIfItDiedForAMinute) {
  kill({Direction::down}, 60s);
  expect_longest("down", "motions arrived there (up alive), ");
  // Exact: 60 s, and the round trip of 10 ms that was on its way, of which 5 ms had come through.
  EXPECT_NEAR(longest["motions"].get<double>(), 60'005, 6);
  EXPECT_EQ(longest["lost_up"], 0);
  EXPECT_EQ(longest["answers"], longest["motions"]);
  EXPECT_EQ(longest["lost_down"], 60'000);
}

TEST_F(ABlackoutOfTheNetwork, NamesTheDirectionUpIfItDied) {
  kill({Direction::up}, 5s);
  expect_longest("up", "motions arrived there (up dead), ");
  EXPECT_EQ(longest["lost_up"], 5000);
  EXPECT_EQ(longest["lost_down"], 0);
}

//   longer than the server waits: it closes the session, and sends Bye in the direction that is alive
TEST_F(ABlackoutOfTheNetwork, NamesTheDirectionUpIfItDiedUntilTheServerClosedTheSession) {
  kill({Direction::up}, 65s);
  expect_longest("up", "(up dead), so no answer was due, and the server ended the session");
  EXPECT_NEAR(longest["lost_up"].get<double>(), 60'000, 300);
}

TEST_F(ABlackoutOfTheNetwork, NamesBothDirectionsIfBothDied) {
  kill({Direction::up, Direction::down}, 2s);
  expect_longest("both", "motions arrived there (up dead), 0 of ");
}

TEST_F(ABlackoutOfTheNetwork, OfARestartedServerNamesNoDirection) {
  loop.kill_server();
  loop.run(2s);
  loop.start_server();
  expect_longest("unknown", "then in another session: the server had restarted");
  EXPECT_TRUE(longest["lost_up"].is_null());
}

TEST_F(ABlackoutOfTheNetwork, NamesNoDirectionWhileTheClientStoodStill) {
  loop.stall(2s);
  expect_longest("neither", "for 2.0");
}

TEST_F(ABlackoutOfTheNetwork, AtTheEndIsExplainedByTheAnswerToTheBye) {
  kill({Direction::up}, 2s);
  expect_longest_at_the_end("up", "until the end: 0 of 2000 motions arrived there (up dead), so no answer was due");
  EXPECT_EQ(longest["lost_up"], 2000);
}

TEST_F(ABlackoutOfTheNetwork, AtTheEndWithoutThatAnswerHasAnUnknownDirection) {
  loop.network().set_blackhole(Direction::down, true);
  loop.run(2s);
  expect_longest_at_the_end("unknown", "it is not known which direction lost the datagrams");
}

}  // namespace
}  // namespace forcebound::sim
