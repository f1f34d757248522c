// Cases 13, 15 and 16: another session's datagrams, a restarted client, a server with false counts of received motions.
//
//     omni -- session --+                                    +--- sphere
//                       +--( delay 5 ms each way )-- server -+
//     omni -- another --+                                    +--- sphere

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;
using netem::Direction;

using Bytes = std::vector<std::byte>;

/// A link that keeps a copy of all that passes.
class RecordingLink final : public net::DatagramLink {
 public:
  explicit RecordingLink(net::DatagramLink& link) : link_(link) {}

  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept override {
    sent.emplace_back(datagram.begin(), datagram.end());
    return link_.send(datagram, to);
  }
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    const auto got = link_.receive(buffer);
    if (got) received.emplace_back(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(got->bytes));
    return got;
  }

  std::vector<Bytes> sent;
  std::vector<Bytes> received;

 private:
  net::DatagramLink& link_;
};

/// A second client in the loop's network, with a device and a clock of its own.
class AnotherClient {
 public:
  AnotherClient(ClosedLoop& loop, net::DatagramLink& link, Nanoseconds now, std::uint64_t seed)
      : clock(now),
        device(device::load_device("omni"), device::make_operator("trace-sphere", 3)),
        session({.server = loop.network().server_address(), .seed = seed}, device,
                control::force_bounding_laws().make("fba-exact", device.facts()), link, clock, {}) {}

  VirtualClock clock;
  device::SimulatedDevice device;
  client::Session session;
};

class SessionHardCase : public testing::Test {
 protected:
  SessionHardCase()
      : loop_({.device = device::load_device("omni"),
               .hand = "trace-sphere",
               .law = "fba-exact",
               .scene = server::load_scene("sphere"),
               .network = {.up = netem::parse_netem("delay 5ms"),
                           .down = netem::parse_netem("delay 5ms"),
                           .trace = {},
                           .seed = 13}}),
        raw_(loop_.network().add_client()),
        link_(raw_) {
    begin_another(1);
    run(2s);
  }

  void begin_another(std::uint64_t seed) { another_.emplace(loop_, link_, now_, seed); }

  void run(Nanoseconds duration) {
    for (const Nanoseconds end = now_ + duration; now_ < end; now_ += 1ms) {
      if (another_) {
        another_->clock.set(now_);
        another_->session.tick(now_);
      }
      loop_.run(1ms);
    }
  }

  void expect_forces_flow() {
    const auto before = another_->session.totals();
    run(500ms);
    const auto after = another_->session.totals();
    EXPECT_EQ(another_->session.state(), client::SessionState::active);
    EXPECT_NEAR(static_cast<double>(after.received - before.received), 500, 2);
    EXPECT_EQ(loop_.session().state(), client::SessionState::active);
    EXPECT_GE(another_->device.audit()->minimum_J, -1e-9);
    EXPECT_GE(loop_.device().audit()->minimum_J, -1e-9);
  }

  /// All that the recorded session sent and received, a datagram of each per millisecond.
  void play_back(const RecordingLink& earlier) {
    for (std::size_t i = 0; i < std::max(earlier.sent.size(), earlier.received.size()); ++i) {
      if (i < earlier.sent.size()) {
        ASSERT_TRUE(raw_.send(earlier.sent[i], loop_.network().server_address()));
      }
      if (i < earlier.received.size()) {
        ASSERT_TRUE(loop_.network().server_link().send(earlier.received[i], loop_.network().client_address(1)));
      }
      run(1ms);
    }
    run(100ms);
  }

  void end_another() {
    bool closed = false;
    for (int i = 0; i < 1000 && !closed; ++i, now_ += 1ms) {
      another_->clock.set(now_);
      closed = another_->session.close(now_);
      loop_.run(1ms);
    }
    EXPECT_TRUE(closed);
    another_.reset();
  }

  Nanoseconds now_{0};
  ClosedLoop loop_;
  net::DatagramLink& raw_;
  RecordingLink link_;
  std::optional<AnotherClient> another_;
};

TEST_F(SessionHardCase, HardCase13AnEarlierSessionPlayedBackAtTheSameAddressChangesNothing) {
  end_another();
  const RecordingLink earlier = link_;
  ASSERT_GT(earlier.sent.size(), 1900U);
  ASSERT_GT(earlier.received.size(), 1900U);
  begin_another(2);
  run(1s);
  const auto before = loop_.server()->counters();
  const auto told = another_->session.totals();
  play_back(earlier);
  const auto after = loop_.server()->counters();
  EXPECT_EQ(after.sessions_opened, before.sessions_opened);
  EXPECT_GE(after.hellos_after_bye, before.hellos_after_bye + 1);
  EXPECT_GE(after.byes_repeated, before.byes_repeated + 1);
  EXPECT_GE(after.motions_duplicated, before.motions_duplicated + 1900);
  const auto totals = another_->session.totals();
  EXPECT_GE(totals.foreign_session - told.foreign_session, earlier.received.size());
  EXPECT_EQ(totals.reconnects, 0U);
  EXPECT_EQ(totals.duplicated, told.duplicated);
  expect_forces_flow();
}

TEST_F(SessionHardCase, HardCase13AnEarlierSessionPlayedBackToAServerThatForgotItChangesNothing) {
  end_another();
  const RecordingLink earlier = link_;
  loop_.kill_server();
  loop_.start_server();
  begin_another(2);
  run(1s);
  ASSERT_EQ(loop_.server()->sessions(), 2U);
  const auto before = loop_.server()->counters();
  const auto told = another_->session.totals();
  play_back(earlier);
  const auto after = loop_.server()->counters();
  EXPECT_LE(loop_.server()->sessions(), 3U) << "an old Hello may open a session, without an effect";
  EXPECT_GE(after.motions_without_session, before.motions_without_session + 1900);
  const auto totals = another_->session.totals();
  EXPECT_GE(totals.foreign_session - told.foreign_session, earlier.received.size())
      << "its Welcome, its forces, its Byes: each is counted";
  EXPECT_EQ(totals.reconnects, 0U);
  expect_forces_flow();
  run(61s);
  EXPECT_EQ(loop_.server()->sessions(), 2U);
}

TEST_F(SessionHardCase, HardCase13MotionOfTenSecondsAgoIsCountedByTheServerAndNotAnswered) {
  const std::vector<Bytes> old = link_.sent;
  ASSERT_GT(old.size(), 1900U);
  run(10s);
  const auto before = loop_.server()->counters();
  const auto told = another_->session.totals();
  for (const Bytes& datagram : old) {
    ASSERT_TRUE(raw_.send(datagram, loop_.network().server_address()));
    run(1ms);
  }
  run(100ms);
  const auto after = loop_.server()->counters();
  EXPECT_EQ(after.motions_duplicated - before.motions_duplicated + after.hellos_repeated - before.hellos_repeated,
            old.size());
  EXPECT_EQ(after.sessions_opened, before.sessions_opened);
  EXPECT_NEAR(static_cast<double>(another_->session.totals().received - told.received),
              static_cast<double>(old.size()) + 100, 5)
      << "no answer twice";
  expect_forces_flow();
}

TEST_F(SessionHardCase, HardCase15AClientKilledAndRestartedAtTheSameAddressWithTheSameSeedGetsForcesAtOnce) {
  for (int kill = 1; kill <= 3; ++kill) {
    SCOPED_TRACE(kill);
    another_.reset();
    run(10ms);
    begin_another(1);
    run(100ms);
    EXPECT_EQ(another_->session.state(), client::SessionState::active);
    EXPECT_GT(another_->session.totals().received, 70U) << "its motions were taken for copies of the dead client's";
    expect_forces_flow();
  }
  run(61s);
  EXPECT_EQ(loop_.server()->sessions(), 2U) << "the dead sessions are closed";
  EXPECT_EQ(loop_.server()->counters().sessions_idle, 3U);
}

/// The test is the server.
class LyingServer : public testing::Test {
 protected:
  void tick() {
    clock_.advance(1ms);
    session_.tick(clock_.now());
  }

  /// The client's last message, if it is of this type.
  template <typename Message>
  std::optional<Message> heard() {
    std::optional<Message> last;
    while (const auto received = network_.server_link().receive(buffer_)) {
      const auto decoded = codec_.decode(std::span(buffer_).first(received->bytes));
      const auto* message = std::get_if<wire::Message>(&decoded);
      if (message != nullptr && std::holds_alternative<Message>(*message)) last = std::get<Message>(*message);
    }
    return last;
  }

  void say(const wire::Message& message) {
    ASSERT_TRUE(network_.server_link().send(codec_.encode(message), network_.client_address(0)));
  }

  VirtualClock clock_;
  SimulatedNetwork network_{clock_, {}};
  device::SimulatedDevice device_{device::load_device("wall-1dof"), device::make_operator("press", 1)};
  client::Session session_{{.server = network_.server_address()},
                           device_,
                           control::force_bounding_laws().make("fba-less", device_.facts()),
                           network_.add_client(),
                           clock_,
                           {}};
  wire::Codec codec_;
  std::array<std::byte, 2048> buffer_{};
};

TEST_F(LyingServer, HardCase16FalseCountsAreIgnored) {
  tick();
  const auto hello = heard<wire::Hello>();
  ASSERT_TRUE(hello.has_value());
  say(wire::Welcome{.client_nonce = hello->client_nonce, .session = 9});
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  constexpr int kTicks = 1000;
  tick();
  for (int i = 0; i < kTicks; ++i) {
    tick();
    const auto motion = heard<wire::MotionSample>();
    ASSERT_TRUE(motion.has_value());
    say(wire::EnvironmentForce{.session = 9,
                               .sequence = i % 2 == 0 ? kMost - static_cast<std::uint64_t>(i) : motion->sequence,
                               .motion_sequence = motion->sequence,
                               .motion_device_time = motion->device_time,
                               .position = motion->position,
                               .motions_received = kMost,
                               .answer = {.force = control::Vector::Constant(1, 1.0)}});
  }
  tick();
  const auto totals = session_.totals();
  EXPECT_EQ(totals.received, 0U);
  EXPECT_EQ(totals.malformed[wire::Malformed::unreadable], kTicks);
  EXPECT_EQ(totals.lost_down, 0U);
  EXPECT_EQ(totals.lost_up, totals.sent);
}

TEST_F(LyingServer, HardCase16AWelcomeOrRefusalForAnotherNonceIsCounted) {
  tick();
  const auto hello = heard<wire::Hello>();
  ASSERT_TRUE(hello.has_value());
  say(wire::Welcome{.client_nonce = hello->client_nonce, .session = 9});
  tick();
  ASSERT_EQ(session_.state(), client::SessionState::active);
  for (std::uint64_t i = 0; i < 10; ++i) {
    say(wire::Welcome{.client_nonce = hello->client_nonce, .session = 9});
    say(wire::Welcome{.client_nonce = i, .session = 100 + i});
    say(wire::Refusal{.client_nonce = i, .reason = wire::RefusalReason::server_full});
    say(wire::Refusal{.session = 100 + i, .reason = wire::RefusalReason::unknown_session});
    tick();
  }
  tick();
  EXPECT_EQ(session_.totals().foreign_session, 30U) << "a further copy of our own Welcome is none of them";
  EXPECT_EQ(session_.totals().reconnects, 0U);
  EXPECT_EQ(session_.state(), client::SessionState::active);
}

}  // namespace
}  // namespace forcebound::sim
