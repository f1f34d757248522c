#include "tests/tools/sim/simulated_network.hpp"

#include <gmock/gmock.h>

#include <array>
#include <string>
#include <vector>

#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// client 0, client 1 -- up --> server that answers at once; it records what it receives and when.
class SimulatedNetworkTest : public testing::Test {
 protected:
  void build(const SimulatedNetworkSettings& settings) {
    network_ = std::make_unique<SimulatedNetwork>(clock_, settings);
    first_ = &network_->add_client();
    second_ = &network_->add_client();
    network_->set_server_handler([this](std::span<const std::byte> datagram, const Address& from, Nanoseconds now) {
      heard_.push_back(text_of(datagram));
      heard_at_.push_back(now);
      network_->server_link().send(bytes_of("re:" + text_of(datagram)), from);
    });
  }

  bool ask(net::DatagramLink& client, std::string_view question) {
    return client.send(bytes_of(question), network_->server_address());
  }

  std::string answer(net::DatagramLink& client) {
    std::array<std::byte, net::kDatagramBytesMax> buffer;
    const auto received = client.receive(buffer);
    if (!received) return "";
    EXPECT_EQ(received->from, network_->server_address());
    return text_of(std::span(buffer).first(received->bytes));
  }

  VirtualClock clock_;
  std::unique_ptr<SimulatedNetwork> network_;
  net::DatagramLink* first_ = nullptr;
  net::DatagramLink* second_ = nullptr;
  std::vector<std::string> heard_;
  std::vector<Nanoseconds> heard_at_;
};

TEST_F(SimulatedNetworkTest, WithoutDelayTheAnswerComesWithinTheTick) {
  build({});
  ASSERT_TRUE(ask(*first_, "a"));
  EXPECT_EQ(answer(*first_), "re:a");
  EXPECT_EQ(answer(*first_), "");
}

TEST_F(SimulatedNetworkTest, AnswersGoToTheClientThatAsked) {
  build({});
  ask(*first_, "a");
  ask(*second_, "b");
  EXPECT_EQ(answer(*second_), "re:b");
  EXPECT_EQ(answer(*first_), "re:a");
  EXPECT_EQ(answer(*second_), "");
}

TEST_F(SimulatedNetworkTest, DelayAppliesEachWayInVirtualTime) {
  build({.up = netem::parse_netem("delay 30ms"), .down = netem::parse_netem("delay 20ms")});
  ask(*first_, "a");
  EXPECT_EQ(network_->next_event(), 30ms);
  clock_.set(49ms);
  EXPECT_EQ(answer(*first_), "");
  EXPECT_THAT(heard_at_, ElementsAre(30ms));
  EXPECT_EQ(network_->next_event(), 50ms);
  clock_.set(50ms);
  EXPECT_EQ(answer(*first_), "re:a");
  EXPECT_EQ(network_->next_event(), std::nullopt);
}

TEST_F(SimulatedNetworkTest, ServerHearsAtTheTimeOfArrivalHoweverFarTheClockJumped) {
  build({.up = netem::parse_netem("delay 30ms"), .down = netem::parse_netem("delay 20ms")});
  ask(*first_, "a");
  clock_.set(1ms);
  ask(*second_, "b");
  clock_.set(10s);
  EXPECT_EQ(answer(*first_), "re:a");
  EXPECT_EQ(answer(*second_), "re:b");
  EXPECT_THAT(heard_at_, ElementsAre(30ms, 31ms));
}

TEST_F(SimulatedNetworkTest, ClientsShareOneLinkPerDirection) {
  // 958 bytes of payload are 8 ms on the wire; the second one waits for the first.
  build({.up = netem::parse_netem("rate 1Mbit")});
  const std::string large(958, 'x');
  ask(*first_, large);
  ask(*second_, large);
  clock_.set(1s);
  network_->deliver_due(clock_.now());
  EXPECT_THAT(heard_at_, ElementsAre(8ms, 16ms));
}

TEST_F(SimulatedNetworkTest, ServerMayPollInsteadOfHandle) {
  build({.up = netem::parse_netem("delay 5ms")});
  network_->set_server_handler(nullptr);
  ask(*second_, "a");
  std::array<std::byte, 16> buffer;
  EXPECT_FALSE(network_->server_link().receive(buffer));
  clock_.set(5ms);
  const auto received = network_->server_link().receive(buffer);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->from, network_->client_address(1));
  network_->server_link().send(bytes_of("b"), received->from);
  EXPECT_EQ(answer(*second_), "b");
}

TEST_F(SimulatedNetworkTest, OversizeDatagramsAreCutAndTellTheirSize) {
  build({});
  network_->set_server_handler(nullptr);
  ask(*first_, std::string(5000, 'x'));
  std::array<std::byte, 16> buffer;
  EXPECT_EQ(network_->server_link().receive(buffer)->bytes, 5000U);
}

TEST_F(SimulatedNetworkTest, KilledServerHearsNothingUntilItIsBack) {
  build({.up = netem::parse_netem("delay 10ms")});
  ask(*first_, "before");
  network_->detach_server();
  clock_.set(20ms);
  EXPECT_EQ(answer(*first_), "");
  EXPECT_EQ(network_->counters().server_detached, 1U);
  ask(*first_, "between");
  network_->attach_server();
  clock_.set(30ms);
  EXPECT_EQ(answer(*first_), "re:between");
}

TEST_F(SimulatedNetworkTest, LastAnswersOfAKilledServerStillArrive) {
  build({.down = netem::parse_netem("delay 10ms")});
  ask(*first_, "a");
  network_->deliver_due(clock_.now());
  network_->detach_server();
  clock_.set(10ms);
  EXPECT_EQ(answer(*first_), "re:a");
}

TEST_F(SimulatedNetworkTest, BlackholeDropsOneDirectionOnly) {
  build({});
  network_->set_blackhole(Direction::down, true);
  ask(*first_, "a");
  EXPECT_EQ(answer(*first_), "");
  EXPECT_THAT(heard_, ElementsAre("a"));
  EXPECT_EQ(network_->counters().blackholed, 1U);
  network_->set_blackhole(Direction::down, false);
  network_->set_blackhole(Direction::up, true);
  ask(*first_, "b");
  EXPECT_EQ(answer(*first_), "");
  EXPECT_THAT(heard_, ElementsAre("a"));
}

TEST_F(SimulatedNetworkTest, UnreadDatagramsAreBoundedAndCounted) {
  build({});
  for (int i = 0; i < 5000; ++i) ask(*first_, "a");
  int answers = 0;
  while (!answer(*first_).empty()) ++answers;
  EXPECT_EQ(answers, 4096);
  EXPECT_EQ(network_->counters().inbox_full, 904U);
}

TEST_F(SimulatedNetworkTest, RefusesToSendToNobody) {
  build({});
  EXPECT_FALSE(first_->send(bytes_of("a"), network_->client_address(1)));
  EXPECT_FALSE(network_->server_link().send(bytes_of("a"), network_->client_address(2)));
  EXPECT_FALSE(network_->server_link().send(bytes_of("a"), network_->server_address()));
}

/// A minute of two clients at 1 kHz, as text: all receptions with their times.
std::string minute(std::uint64_t seed) {
  VirtualClock clock;
  const netem::NetemParameters bad = netem::parse_netem("delay 20ms 15ms loss gemodel 2% 20% duplicate 2% corrupt 1%");
  SimulatedNetwork network(clock, {.up = bad, .down = bad, .seed = seed});
  std::array<net::DatagramLink*, 2> clients{&network.add_client(), &network.add_client()};
  network.set_server_handler([&](std::span<const std::byte> datagram, const Address& from, Nanoseconds) {
    network.server_link().send(datagram, from);
  });
  std::string log;
  std::array<std::byte, 64> buffer;
  for (int tick = 0; tick < 60'000; ++tick) {
    clock.set(tick * 1ms);
    for (std::size_t i = 0; i < clients.size(); ++i) {
      while (const auto received = clients[i]->receive(buffer))
        log += std::to_string(tick) + "," + std::to_string(i) + "," +
               text_of(std::span(buffer).first(received->bytes)) + "\n";
      clients[i]->send(bytes_of(std::to_string(tick)), network.server_address());
    }
  }
  return log;
}

TEST(SimulatedNetwork, OneSeedGivesOneRunBitForBit) {
  const std::string first = minute(3);
  EXPECT_GT(first.size(), 500'000U);
  EXPECT_EQ(first, minute(3));
  EXPECT_NE(first, minute(4));
}

TEST_F(SimulatedNetworkTest, VerdictsAreObservable) {
  build({.up = netem::parse_netem("loss 100%")});
  std::vector<std::string> verdicts;
  network_->set_verdict_observer([&](Direction direction, const netem::Verdict& verdict) {
    verdicts.push_back(std::string(to_string(direction)) + " " + netem::verdict_text(verdict));
  });
  ask(*first_, "a");
  EXPECT_THAT(verdicts, ElementsAre("up lost"));
  EXPECT_EQ(network_->counters(Direction::up).lost, 1U);
}

}  // namespace
}  // namespace forcebound::sim
