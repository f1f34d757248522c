#include "tests/tools/relay/relay.hpp"

#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <string>

#include "tests/unit/tools/relay/kept_links.hpp"

namespace forcebound::relay {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

class CountingObserver final : public PacketObserver {
 public:
  void on_verdict(Direction direction, const netem::Verdict&) noexcept override { ++verdicts[direction]; }
  void on_departure(Direction direction, const netem::Verdict& verdict) noexcept override {
    ++departures[direction];
    last_delay = verdict.delay;
  }
  std::map<Direction, int> verdicts;
  std::map<Direction, int> departures;
  Nanoseconds last_delay{0};
};

/// clients (ports 1, 2, ...) <--> downstream_ | relay | upstream_.links[0, 1, ...] <--> server (port 9000)
class RelayTest : public testing::Test {
 protected:
  void build(std::string_view up = "", std::string_view down = "", std::size_t flows_max = 256) {
    relay_ = std::make_unique<Relay>(RelaySettings{.up = {.netem = netem::parse_netem(up)},
                                                   .down = {.netem = netem::parse_netem(down)},
                                                   .upstream = at(kServerPort),
                                                   .flows_max = flows_max,
                                                   .flow_idle = 60s},
                                     downstream_, upstream_, &observer_);
  }

  void client_sends(std::uint16_t port, std::string text) { downstream_.waiting.emplace_back(port, std::move(text)); }
  void server_sends(std::size_t flow, std::string text) {
    upstream_.links.at(flow)->waiting.emplace_back(kServerPort, std::move(text));
  }

  void turn(Nanoseconds now) {
    relay_->forward(now);
    relay_->receive(now);
    relay_->forward(now);
  }

  KeptLink downstream_;
  KeptUpstream upstream_;
  CountingObserver observer_;
  std::unique_ptr<Relay> relay_;
};

TEST_F(RelayTest, GivesEachClientAnUpstreamOfItsOwn) {
  build();
  client_sends(1, "a");
  client_sends(2, "b");
  client_sends(1, "c");
  turn(0ns);
  ASSERT_THAT(upstream_.links, SizeIs(2));
  EXPECT_THAT(upstream_.links[0]->sent, ElementsAre(Pair(kServerPort, "a"), Pair(kServerPort, "c")));
  EXPECT_THAT(upstream_.links[1]->sent, ElementsAre(Pair(kServerPort, "b")));
}

TEST_F(RelayTest, AnswersGoToTheClientOfTheirUpstream) {
  build();
  client_sends(1, "a");
  client_sends(2, "b");
  turn(0ns);
  server_sends(1, "re:b");
  server_sends(0, "re:a");
  turn(1ms);
  EXPECT_THAT(downstream_.sent, testing::UnorderedElementsAre(Pair(1, "re:a"), Pair(2, "re:b")));
}

TEST_F(RelayTest, EachDirectionHasItsOwnImpairment) {
  build("delay 30ms", "delay 20ms");
  client_sends(1, "a");
  turn(0ns);
  EXPECT_EQ(relay_->next_departure(), 30ms);
  turn(30ms - 1ns);
  EXPECT_THAT(upstream_.links[0]->sent, IsEmpty());
  turn(30ms);
  EXPECT_THAT(upstream_.links[0]->sent, SizeIs(1));
  server_sends(0, "re:a");
  turn(30ms);
  EXPECT_EQ(relay_->next_departure(), 50ms);
  turn(50ms);
  EXPECT_THAT(downstream_.sent, ElementsAre(Pair(1, "re:a")));
  EXPECT_EQ(relay_->next_departure(), std::nullopt);
}

TEST_F(RelayTest, CarriesDatagramsOfAnySizeUdpCanHold) {
  build();
  client_sends(1, "");
  client_sends(1, std::string(60'000, 'x'));
  turn(0ns);
  EXPECT_THAT(upstream_.links[0]->sent,
              ElementsAre(Pair(kServerPort, ""), Pair(kServerPort, std::string(60'000, 'x'))));
}

TEST_F(RelayTest, RefusesClientsBeyondItsRoomAndKeepsServingTheOthers) {
  build("", "", 2);
  for (std::uint16_t port = 1; port <= 4; ++port) client_sends(port, "a");
  client_sends(2, "b");
  turn(0ns);
  EXPECT_EQ(relay_->flows(), 2U);
  EXPECT_EQ(relay_->counters().flow_refused, 2U);
  EXPECT_THAT(upstream_.links[1]->sent, SizeIs(2));
}

TEST_F(RelayTest, CountsClientsForWhomTheSystemHasNoSocket) {
  build();
  upstream_.exhausted = true;
  client_sends(1, "a");
  turn(0ns);
  EXPECT_EQ(relay_->counters().flow_refused, 1U);
}

TEST_F(RelayTest, ABlackholeKillsItsOwnWayForItsTimeOnly) {
  relay_ = std::make_unique<Relay>(
      RelaySettings{.up = {.blackholes = {{.from = 1s, .to = 2s}}}, .upstream = at(kServerPort), .flow_idle = 60s},
      downstream_, upstream_, &observer_);
  for (const auto& [now, text] : {std::pair{0ms, "a"}, {999ms, "b"}, {1000ms, "c"}, {1999ms, "d"}, {2000ms, "e"}}) {
    client_sends(1, text);
    turn(now);
    server_sends(0, text);
    turn(now);
  }
  EXPECT_THAT(upstream_.links[0]->sent,
              ElementsAre(Pair(kServerPort, "a"), Pair(kServerPort, "b"), Pair(kServerPort, "e")));
  EXPECT_THAT(downstream_.sent, SizeIs(5));
  EXPECT_EQ(relay_->impairment(Direction::up).counters().blackout, 2U);
  EXPECT_EQ(observer_.verdicts[Direction::up], 5) << "the log has them too";
}

TEST_F(RelayTest, ForgetsAnIdleClientAndMakesRoom) {
  build("", "", 1);
  client_sends(1, "a");
  turn(0ns);
  turn(60s);
  EXPECT_EQ(relay_->flows(), 1U);
  client_sends(2, "b");
  turn(60s + 1ns);
  EXPECT_EQ(relay_->counters().flows_expired, 1U);
  ASSERT_THAT(upstream_.links, SizeIs(1));
  EXPECT_THAT(upstream_.links[0]->sent, ElementsAre(Pair(kServerPort, "b")));
}

TEST_F(RelayTest, TheServersDatagramsKeepAClientFromExpiringToo) {
  build();
  client_sends(1, "a");
  turn(0ns);
  server_sends(0, "b");
  turn(50s);
  turn(100s);
  EXPECT_EQ(relay_->flows(), 1U);
}

TEST_F(RelayTest, CountsWhatLeavesForAForgottenClient) {
  build("delay 100s");
  client_sends(1, "a");
  turn(0ns);
  turn(70s);
  turn(100s);
  EXPECT_EQ(relay_->counters().orphaned, 1U);
}

TEST_F(RelayTest, CountsWhatTheSystemDoesNotTake) {
  build();
  client_sends(1, "a");
  turn(0ns);
  server_sends(0, "b");
  downstream_.broken = true;
  turn(1ms);
  EXPECT_EQ(relay_->counters().send_failed, 1U);
}

TEST_F(RelayTest, AFloodOnOneLinkIsTakenInPieces) {
  build();
  for (int i = 0; i < 1000; ++i) client_sends(1, "a");
  turn(0ns);
  EXPECT_LT(relay_->impairment(Direction::up).counters().received, 100U);
  for (int i = 0; i < 100; ++i) turn(i * 1us);
  EXPECT_EQ(relay_->impairment(Direction::up).counters().forwarded, 1000U);
}

TEST_F(RelayTest, MeasuresTheDelayItAddsItself) {
  build("delay 10ms");
  client_sends(1, "a");
  client_sends(1, "b");
  turn(0ns);
  turn(12ms);
  EXPECT_EQ(relay_->lateness().packets, 2U);
  EXPECT_EQ(relay_->lateness().late, 2U);
  EXPECT_EQ(relay_->lateness().most, 2ms);
  EXPECT_EQ(relay_->lateness().total, 4ms);
}

TEST_F(RelayTest, ReportsEveryVerdictAndEveryDeparture) {
  build("delay 5ms loss 50% duplicate 50%");
  for (int i = 0; i < 1000; ++i) {
    client_sends(1, "a");
    turn(i * 1ms);
  }
  turn(2s);
  const auto& counted = relay_->impairment(Direction::up).counters();
  EXPECT_EQ(static_cast<std::uint64_t>(observer_.verdicts[Direction::up]), 1000 + counted.duplicated);
  EXPECT_EQ(static_cast<std::uint64_t>(observer_.departures[Direction::up]), counted.forwarded);
  EXPECT_EQ(observer_.last_delay, 5ms);
}

}  // namespace
}  // namespace forcebound::relay
