#include <algorithm>
#include <random>

#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

class ServerAbuse : public ServerFixture {};

TEST_F(ServerAbuse, CountsMalformedDatagramsByReason) {
  server->on_datagram({}, address(1), clock.time);
  server->on_datagram(std::vector<std::byte>(100), address(1), clock.time);
  server->on_datagram(std::vector<std::byte>(1400), address(1), clock.time);
  const auto malformed = server->counters().malformed;
  EXPECT_EQ(malformed[wire::Malformed::truncated], 1u);
  EXPECT_EQ(malformed[wire::Malformed::foreign], 1u);
  EXPECT_EQ(malformed[wire::Malformed::oversize], 1u);
  EXPECT_TRUE(answers().empty());
}

TEST_F(ServerAbuse, IgnoresMessagesThatOnlyServersSend) {
  arrive(wire::Welcome{});
  arrive(wire::Refusal{});
  arrive(wire::EnvironmentForce{});
  EXPECT_EQ(server->counters().unexpected, 3u);
  EXPECT_TRUE(answers().empty());
}

TEST_F(ServerAbuse, AMotionTooShortForARefusalGetsNone) {
  // A frame of a motion without any field: its checksum is that of the kind alone.
  const std::vector<std::byte> empty{std::byte{'F'},  std::byte{'B'},  std::byte{1},    std::byte{4},
                                     std::byte{0x94}, std::byte{0x2b}, std::byte{0x6f}, std::byte{0xd5}};
  server->on_datagram(empty, address(1), clock.time);
  EXPECT_TRUE(answers().empty());
}

TEST_F(ServerAbuse, RandomBytesGetNoAnswer) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> byte(0, 255);
  std::uniform_int_distribution<std::size_t> length(0, 1500);
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> bytes(length(random));
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(byte(random)); });
    server->on_datagram(bytes, address(1), clock.time);
  }
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(server->counters().datagrams, 5000u);
}

TEST_F(ServerAbuse, NoAnswerToAnUntrustedClientIsLargerThanItsRequest) {
  wire::Codec client;
  auto endless = hello();
  const std::string name(100, 'x');
  endless.scene = name;
  endless.device = name;
  const std::vector<wire::Message> questions{hello(), endless, motion(99, 1), motion(0, 0)};
  for (const auto& question : questions) {
    const std::size_t bytes = client.encode(question).size();
    arrive(question);
    ASSERT_EQ(link.sent.size(), 1u);
    EXPECT_LE(link.sent[0].bytes.size(), bytes);
    link.sent.clear();
  }
}

TEST_F(ServerAbuse, AnAddressThatIsNotProvenGetsNoMoreBytesThanItSent) {
  const auto session = join();
  arrive(motion(session, 1));
  (void)answers();
  wire::Codec client;
  std::size_t sent = 0;
  for (std::uint64_t sequence = 2; sequence < 1000; ++sequence) {
    const auto datagram = motion(session, sequence);
    sent += client.encode(datagram).size();
    arrive(datagram, address(66));
  }
  const wire::Bye bye{.session = session};
  sent += client.encode(bye).size();
  arrive(bye, address(66));
  std::size_t answered = 0;
  for (const auto& answer : link.sent) answered += answer.bytes.size();
  EXPECT_GT(answered, 0u);
  EXPECT_LE(answered, sent);
  const auto counters = server->counters();
  EXPECT_EQ(counters.motions_unanswered() + counters.forces_sent, counters.motions_received);
}

TEST_F(ServerAbuse, AFloodOfHellosIsBounded) {
  for (std::uint64_t nonce = 1; nonce <= 10000; ++nonce) {
    clock.time = milliseconds{nonce};
    arrive(hello(nonce), address(static_cast<std::uint16_t>(nonce)));
  }
  const auto counters = server->counters();
  EXPECT_EQ(server->sessions(), 64u);
  // 10 s at 50 a second, and one second's worth at once.
  EXPECT_NEAR(static_cast<double>(link.sent.size()), 550, 2);
  EXPECT_EQ(counters.hellos_over_rate + counters.hellos_refused + counters.sessions_opened, 10000u);
}

TEST_F(ServerAbuse, AFloodOfHellosLetsClientsFromElsewhereIn) {
  for (std::uint64_t nonce = 1; nonce <= 1000; ++nonce) arrive(hello(nonce), address(9));
  (void)answers();
  // One of them may share the flood's bucket.
  std::size_t answered = 0;
  for (std::uint8_t last = 1; last <= 8; ++last) {
    net::Address elsewhere{.ip = {0x20, last}, .port = 1};
    arrive(hello(5000), elsewhere);
    answered += answers().size();
  }
  EXPECT_GE(answered, 6u);
}

TEST_F(ServerAbuse, AFloodOfCopiesOfAHelloIsBounded) {
  (void)join();
  for (int i = 0; i < 1000; ++i) arrive(hello());
  EXPECT_EQ(link.sent.size(), 20u);
  EXPECT_EQ(server->counters().hellos_over_rate, 980u);
}

TEST_F(ServerAbuse, AnEarlierSessionReplayedWholeChangesNothing) {
  const auto old_session = join(1, address(1));
  arrive(motion(old_session, 1), address(1));
  arrive(wire::Bye{.session = old_session}, address(1));
  answers();
  const auto session = join(2, address(1));
  arrive(motion(session, 2, 0.001), address(1));
  answers();

  arrive(hello(1), address(1));
  arrive(motion(old_session, 1), address(1));
  arrive(wire::Bye{.session = old_session}, address(1));
  answers();
  arrive(motion(session, 3, 0.003), address(1));
  const auto force = only_answer<wire::EnvironmentForce>();
  EXPECT_EQ(force.session, session);
  EXPECT_EQ(force.sequence, 2u);
  EXPECT_EQ(force.motions_received, 2u);
}

TEST_F(ServerAbuse, ANumberFarAheadDoesNotEndASession) {
  const auto session = join();
  arrive(motion(session, 1));
  arrive(motion(session, 1 + (std::uint64_t{1} << 63)));
  arrive(motion(session, std::uint64_t{1} << 62));
  arrive(motion(session, std::uint64_t{1} << 20));
  (void)answers();
  arrive(motion(session, 2));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().motion_sequence, 2u);
  EXPECT_EQ(server->counters().motions_far_ahead, 2u);
  EXPECT_EQ(server->counters().motions_duplicated, 1u) << "half a circle away is behind";
  EXPECT_EQ(server->counters().motions_received, 2u);
}

TEST_F(ServerAbuse, AfterABlackoutNumbersMayBeAsFarAheadAsItWasLong) {
  const auto session = join();
  arrive(motion(session, 1));
  (void)answers();
  clock.time += std::chrono::seconds{50};
  arrive(motion(session, 50'001));
  EXPECT_EQ(only_answer<wire::EnvironmentForce>().motion_sequence, 50'001u);
  EXPECT_EQ(server->counters().motions_far_ahead, 0u);
}

TEST_F(ServerAbuse, NonsenseInAHelloIsHarmless) {
  for (const double period_s : {-1.0, 0.0, 1e-300, 1e300}) {
    auto question = hello(static_cast<std::uint64_t>(link.sent.size()) + 1);
    question.period_s = period_s;
    question.device = "line\nbreak \x1b[31m";
    arrive(question);
  }
  EXPECT_EQ(server->sessions(), 4u);
  for (const auto& line : diary.lines) EXPECT_EQ(line, "opened line?break ?[31m in wall");
}

TEST_F(ServerAbuse, MotionAtTheLargestNumbersGetsFiniteForces) {
  const auto session = join();
  for (const double x : {1e300, -1e300, 1.7e308, 5e-324}) {
    static std::uint64_t sequence = 0;
    arrive(motion(session, ++sequence, x));
    EXPECT_TRUE(only_answer<wire::EnvironmentForce>().answer.force.allFinite());
  }
  EXPECT_EQ(server->counters().objects_quarantined, 1u);
}

}  // namespace
}  // namespace forcebound::server
