#include "forcebound/client/session/session_link.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

/// The test plays the server and the other stages.
class SessionLinkTest : public ::testing::Test {
 protected:
  SessionLinkTest() { reading.position = Vector::Zero(1); }

  void tick() {
    clock.time += 1ms;
    reading.latched = clock.time;
    if (link.is_motion_due(reading, reading.position)) {
      (void)link.send(
          {.device_time = clock.time, .position = reading.position, .handle = reading.handle, .energy_given_J = 3});
    }
    receive();
    link.keep_connected(clock.time);
  }

  void receive() {
    for (MessageLink::Received in_tick; const auto arrival = link.receive(clock.time, in_tick);) {
      kinds.push_back(arrival->message.index());
      newest.push_back(arrival->newest);
    }
  }

  template <typename Message>
  std::vector<Message> sent() {
    std::vector<Message> messages;
    for (const auto& datagram : datagrams.sent) {
      const auto decoded = codec.decode(datagram.bytes);
      const auto& message = std::get<wire::Message>(decoded);
      if (std::holds_alternative<Message>(message)) messages.push_back(std::get<Message>(message));
    }
    datagrams.sent.clear();
    return messages;
  }

  void arrive(const wire::Message& message) { datagrams.arrive(codec.encode(message), kServer); }

  void connect(bool takes_energy = false) {
    tick();
    arrive(wire::Welcome{
        .client_nonce = sent<wire::Hello>().at(0).client_nonce, .session = kSession, .takes_energy = takes_energy});
    tick();
    ASSERT_EQ(link.state(), SessionState::active);
    forget();
  }

  void forget() {
    datagrams.sent.clear();
    kinds.clear();
    newest.clear();
  }

  wire::EnvironmentForce answer(const wire::MotionSample& motion) {
    wire::EnvironmentForce force;
    force.session = kSession;
    force.sequence = ++forces;
    force.motion_sequence = motion.sequence;
    force.motion_device_time = motion.device_time;
    force.answer.force = Vector::Zero(1);
    force.position = motion.position;
    force.motions_received = std::max(motion.sequence, forces);
    return force;
  }

  [[nodiscard]] record::RunTotals totals() const {
    record::RunTotals totals;
    link.add_to(totals, clock.time);
    return totals;
  }

  /// With 600 motions of which one is answered.
  void connect_for_a_while() {
    connect();
    tick();
    arrive(answer(sent<wire::MotionSample>().at(0)));
    for (int i = 0; i < 600; ++i) tick();
  }

  /// Closes; the last motion arrives 450 ms after all others, and an earlier one was 460 motions late. Of the answers
  /// those at some times arrive. @returns after how many ms it was closed; 2000: it was not
  int close_with_a_late_motion(const std::function<bool(int ms)>& arrives) {
    const std::uint64_t motions = totals().sent;
    int ms = 0;
    for (bool closed = false; ms < 2000 && !closed; ++ms) {
      clock.time += 1ms;
      link.begin_closing(clock.time);
      receive();
      closed = link.close(clock.time);
      const std::uint64_t received = ms < 450 ? motions - 1 : motions;
      for (const auto& bye : sent<wire::Bye>()) {
        if (!arrives(ms)) continue;
        arrive(
            wire::Bye{.session = bye.session, .motions_received = received, .forces_sent = 1, .motions_behind = 460});
      }
    }
    return ms;
  }

  template <typename Message>
  static std::size_t kind_of() {
    return wire::index_in<Message>(static_cast<const wire::Message*>(nullptr));
  }

  test::FakeLink datagrams;
  test::FakeClock clock;
  Events events;
  EventReporter reporter{&events};
  wire::Codec codec;
  device::Reading reading;
  std::vector<std::size_t> kinds;  ///< of messages for other stages
  std::vector<bool> newest;        ///< likewise
  std::uint64_t forces = 0;
  SessionLink link{{.server = kServer}, datagrams, clock, reporter};
};

TEST_F(SessionLinkTest, RefusesRareMotionsWithALawThatExchangesNumbersOnEach) {
  const SessionLink::Options options{.server = kServer, .facts = {.server_law = "wave"}, .send_rate = {.most_Hz = 20}};
  EXPECT_THROW(SessionLink(options, datagrams, clock, reporter), std::invalid_argument);
}

TEST_F(SessionLinkTest, SendsNoMotionWithoutASession) {
  tick();
  tick();
  EXPECT_TRUE(sent<wire::MotionSample>().empty());
  EXPECT_EQ(totals().reconnects, 0U);
}

TEST_F(SessionLinkTest, NumbersMotionsAndProvesItsAddressAsTheServerAsks) {
  connect();
  tick();
  wire::EnvironmentForce force = answer(sent<wire::MotionSample>().at(0));
  force.challenge = 99;
  arrive(force);
  tick();
  tick();
  const auto motions = sent<wire::MotionSample>();
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[0].sequence, 2U);
  EXPECT_EQ(motions[0].challenge, 0U);
  EXPECT_EQ(motions[1].sequence, 3U);
  EXPECT_EQ(motions[1].challenge, 99U);
  EXPECT_EQ(motions[1].session, kSession);
}

TEST_F(SessionLinkTest, TellsNoEnergyGivenToAServerThatDoesNotTakeIt) {
  connect();
  tick();
  EXPECT_EQ(sent<wire::MotionSample>().at(0).energy_given_J, 0);
}

TEST_F(SessionLinkTest, TellsTheEnergyGivenToAServerThatTakesIt) {
  connect(true);
  tick();
  EXPECT_EQ(sent<wire::MotionSample>().at(0).energy_given_J, 3);
}

TEST_F(SessionLinkTest, SendsNoMotionOfAReadingThatWasLost) {
  connect();
  reading.position[0] = std::numeric_limits<double>::quiet_NaN();
  tick();
  EXPECT_TRUE(sent<wire::MotionSample>().empty());
}

TEST_F(SessionLinkTest, GivesEachMessageOfTheSessionOnce) {
  tick();
  const auto nonce = sent<wire::Hello>().at(0).client_nonce;
  arrive(wire::Welcome{.client_nonce = nonce, .session = kSession});
  arrive(wire::Welcome{.client_nonce = nonce, .session = kSession});
  tick();
  EXPECT_EQ(kinds, (std::vector{kind_of<wire::Welcome>()}));
  tick();
  tick();
  const auto motions = sent<wire::MotionSample>();
  forget();
  const auto older = answer(motions.at(0));
  const auto newer = answer(motions.at(1));
  arrive(newer);
  arrive(newer);
  arrive(older);
  arrive(wire::ScenePiece{.session = kSession});
  arrive(wire::ViewPiece{.session = kSession, .pieces = 1});
  arrive(wire::Bye{.session = kSession});
  arrive(wire::Bye{.session = kSession});
  arrive(wire::ViewPiece{.session = kSession, .pieces = 1});
  tick();
  EXPECT_EQ(kinds, (std::vector{kind_of<wire::EnvironmentForce>(), kind_of<wire::EnvironmentForce>(),
                                kind_of<wire::ScenePiece>(), kind_of<wire::ViewPiece>(), kind_of<wire::Bye>()}));
  EXPECT_EQ(newest, (std::vector{true, false, false, false, false}));
  EXPECT_EQ(link.forces().newest()->motion_sequence, newer.motion_sequence);
  EXPECT_EQ(link.forces().newest_arrival(), clock.time);
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::server_left}));
}

TEST_F(SessionLinkTest, SaysWhichEndToUpdateWhenTheServerSpeaksAnotherVersion) {
  tick();
  wire::Refusal refusal{.client_nonce = sent<wire::Hello>().at(0).client_nonce,
                        .reason = wire::RefusalReason::version_mismatch,
                        .text = "this server speaks protocol version 1, the client 2"};
  arrive(refusal);  // version 1 says its version in the text alone
  tick();
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::refused}));
  EXPECT_EQ(events.words, "the server speaks protocol version 1, the client version 2: update the server");
  EXPECT_TRUE(link.refused());
  EXPECT_EQ(link.state(), SessionState::connecting);

  refusal.protocol_version = 3;
  arrive(refusal);
  tick();
  EXPECT_EQ(events.words, "the server speaks protocol version 3, the client version 2: update the client");
  EXPECT_EQ(totals().refusals, 2U);
}

TEST_F(SessionLinkTest, ReplacesControlCharactersInTheServersText) {
  tick();
  arrive(wire::Refusal{.client_nonce = sent<wire::Hello>().at(0).client_nonce, .text = "full\x1b[2J\nreally"});
  tick();
  EXPECT_EQ(events.words, "full?[2J?really");
}

TEST_F(SessionLinkTest, ACopyOfTheServersByeDoesNotEndTheNextSession) {
  connect();
  arrive(wire::Bye{.session = kSession});
  tick();
  const auto hellos = sent<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  arrive(wire::Bye{.session = kSession});
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession + 1});
  tick();
  tick();
  EXPECT_EQ(link.state(), SessionState::active);
  EXPECT_EQ(sent<wire::MotionSample>().back().session, kSession + 1);
  EXPECT_EQ(totals().reconnects, 1U);
}

TEST_F(SessionLinkTest, ALinkThatIsDownIsCountedAndHarmless) {
  connect();
  datagrams.works = false;
  for (int i = 0; i < 10; ++i) tick();
  EXPECT_EQ(totals().send_failures, 10U);
  EXPECT_EQ(totals().sent, 0U) << "what was never sent is not lost";
}

TEST_F(SessionLinkTest, ReportsOnceWhatTheRobotAtTheFarEndDoes) {
  connect();
  const auto answer_with = [this](control::FollowerState state) {
    tick();
    wire::EnvironmentForce force = answer(sent<wire::MotionSample>().back());
    force.answer.follower = state;
    arrive(force);
  };
  answer_with(control::FollowerState::waiting);
  answer_with(control::FollowerState::waiting);
  tick();
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::follower_changed}));
  EXPECT_EQ(events.follower, control::FollowerState::waiting);
  EXPECT_EQ(events.words, "keep the device still for a moment");
  reading.handle.buttons = 0;
  answer_with(control::FollowerState::following);
  tick();
  EXPECT_EQ(events.kinds.size(), 2U);
  EXPECT_EQ(events.follower, control::FollowerState::following);
  EXPECT_EQ(events.words, "press and release the clutch") << "its device has buttons";
}

TEST_F(SessionLinkTest, WaitsOnCloseAsLongAsTheMostDelayedMotionWasLate) {
  connect_for_a_while();
  EXPECT_LT(close_with_a_late_motion([](int) { return true; }), 1000);
  EXPECT_EQ(totals().lost_up, 0U);
  EXPECT_EQ(totals().in_flight, 0U);
}

TEST_F(SessionLinkTest, DoesNotTakeSilenceOnCloseForCountsThatNoLongerChange) {
  connect_for_a_while();
  const int ms = close_with_a_late_motion([](int at_ms) { return at_ms < 300 || at_ms >= 1200; });
  EXPECT_GE(ms, 1200);
  EXPECT_LT(ms, 2000);
  EXPECT_EQ(totals().lost_up, 0U) << "the answers that told of it were lost";
}

TEST_F(SessionLinkTest, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  connect();
  tick();
  const auto bytes = codec.encode(answer(sent<wire::MotionSample>().at(0)));
  const std::vector<std::byte> force(bytes.begin(), bytes.end());
  datagrams.reserve(1);
  datagrams.keep = false;
  kinds.reserve(10);
  newest.reserve(10);
  const test::AllocationGuard guard;
  datagrams.arrive_again(force, kServer);
  for (int i = 0; i < 1300; ++i) tick();
  link.begin_closing(clock.time);
  (void)link.close(clock.time);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(totals().received, 1U);
}

}  // namespace
}  // namespace forcebound::client
