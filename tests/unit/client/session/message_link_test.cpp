#include "forcebound/client/session/message_link.hpp"

#include <gtest/gtest.h>

#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

/// Within a session.
class MessageLinkTest : public ::testing::Test {
 protected:
  MessageLinkTest() {
    (void)connection.on_welcome({.client_nonce = connection.hello(0s).client_nonce, .session = kSession});
  }

  /// How many messages come of what has arrived on one tick.
  int receive() {
    int messages = 0;
    for (MessageLink::Received in_tick; link.receive(connection, in_tick);) ++messages;
    return messages;
  }

  void arrive(const wire::Message& message, const net::Address& from = kServer) {
    datagrams.arrive(codec.encode(message), from);
  }

  [[nodiscard]] std::uint64_t malformed(wire::Malformed reason) const { return link.counts().malformed[reason]; }

  const wire::Bye bye{.session = kSession};
  test::FakeLink datagrams;
  test::FakeClock clock;
  wire::Codec codec;
  Connection connection{{}, 1};
  MessageLink link{datagrams, clock, kServer};
};

TEST_F(MessageLinkTest, CountsRejectedDatagramsByReason) {
  arrive(bye, kOtherAddress);
  arrive(wire::Bye{.session = kSession + 1});
  const std::array<std::byte, 3> noise{};
  datagrams.arrive(noise, kServer);
  arrive(wire::MotionSample{.session = kSession, .sequence = 1, .position = Vector::Zero(1)});
  EXPECT_EQ(receive(), 0);
  EXPECT_EQ(link.counts().foreign, 2U);
  EXPECT_EQ(malformed(wire::Malformed::truncated), 1U);
  EXPECT_EQ(malformed(wire::Malformed::unreadable), 1U);
}

TEST_F(MessageLinkTest, LeavesWhatIsTooMuchForOneTickToTheNext) {
  for (int i = 0; i < 100; ++i) arrive(bye);
  EXPECT_EQ(receive(), 64);
  EXPECT_EQ(receive(), 36);
}

TEST_F(MessageLinkTest, AFloodFromElsewhereDelaysNothingUntilItIsTooMuchToDrop) {
  for (int i = 0; i < 500; ++i) arrive(bye, kOtherAddress);
  arrive(bye);
  EXPECT_EQ(receive(), 1);
  for (int i = 0; i < 600; ++i) arrive(bye, kOtherAddress);
  arrive(bye);
  EXPECT_EQ(receive(), 0);
  EXPECT_EQ(receive(), 1);
}

TEST_F(MessageLinkTest, AMessageArrivedWhenItsDatagramDid) {
  clock.time = 5ms;
  datagrams.waited = 700us;
  arrive(bye);
  MessageLink::Received in_tick;
  EXPECT_EQ(link.receive(connection, in_tick)->at, 4300us);
}

TEST_F(MessageLinkTest, CountsWhatTheSystemDoesNotSend) {
  datagrams.works = false;
  EXPECT_FALSE(link.send(bye));
  EXPECT_EQ(link.counts().send_failures, 1U);
}

}  // namespace
}  // namespace forcebound::client
