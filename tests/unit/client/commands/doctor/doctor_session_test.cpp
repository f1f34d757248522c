#include "forcebound/client/commands/doctor/doctor_session.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <random>

#include "forcebound/client/commands/doctor/network_findings.hpp"
#include "forcebound/server/environment/scene_environment.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/session/server.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_link.hpp"
#include "tests/tools/sim/simulated_network.hpp"
#include "tests/tools/sim/skewed_clock.hpp"
#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::client::commands {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A session of the doctor's and a real server, in virtual time:
///
///     session, each millisecond ==( up / down )== server, scene, a clock of its own
class DoctorSessionTest : public testing::Test {
 protected:
  struct Setting {
    std::string up{};
    std::string down{};
    std::string scene = "sphere";
    int degrees_of_freedom = 3;
    sim::ClockSkew server_clock{};
  };

  void build(const Setting& setting) {
    server_clock_.emplace(clock_, setting.server_clock);
    network_ = std::make_unique<sim::SimulatedNetwork>(
        clock_,
        sim::SimulatedNetworkSettings{.up = netem::parse_netem(setting.up), .down = netem::parse_netem(setting.down)});
    server::EnvironmentLibrary environments;
    environments.add(server::scene_environment(server::load_scene(setting.scene)));
    server_ = std::make_unique<server::Server>(server::ServerOptions{.scene = setting.scene}, std::move(environments),
                                               network_->server_link(), *server_clock_,
                                               [random = std::mt19937_64(1)]() mutable { return random() | 1U; });
    network_->set_server_handler(
        [this](std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now) {
          server_->on_datagram(datagram, from, server_clock_->shown_at(now));
        });
    session_ = std::make_unique<DoctorSession>(
        DoctorSession::Settings{
            .server = network_->server_address(), .degrees_of_freedom = setting.degrees_of_freedom, .answers = 20000},
        network_->add_client(), clock_);
  }

  /// The server reads the clock too, so that it is set to the time of each arrival.
  void live_until(Nanoseconds time) {
    for (auto next = network_->next_event(); next && *next <= time; next = network_->next_event()) {
      clock_.set(std::max(*next, clock_.now()));
      network_->deliver_due(clock_.now());
    }
    clock_.set(time);
  }

  void connect() {
    for (int i = 0; i < 10000 && !session_->connected() && session_->handshake().refusal.empty(); ++i) {
      session_->keep_connected();
      live_until(clock_.now() + 1ms);
      session_->receive();
    }
  }

  void tick_for(Nanoseconds duration) {
    for (const Nanoseconds end = clock_.now() + duration; clock_.now() < end; live_until(clock_.now() + 1ms))
      session_->tick();
    session_->receive();
  }

  void close() {
    bool closed = false;
    for (int i = 0; i < 10000 && !closed; ++i) {
      closed = session_->close();
      live_until(clock_.now() + 1ms);
    }
    EXPECT_TRUE(closed);
  }

  /// What it finds after the end.
  NetworkFindings findings() {
    const Nanoseconds gap = session_->longest_gap();
    close();
    return network_findings(session_->answers(), session_->counts(), gap);
  }

  sim::VirtualClock clock_{1s};
  std::optional<sim::SkewedClock> server_clock_;
  std::unique_ptr<sim::SimulatedNetwork> network_;
  std::unique_ptr<server::Server> server_;
  std::unique_ptr<DoctorSession> session_;
};

TEST_F(DoctorSessionTest, TellsWhatTheHandshakeTookAndWhatTheServerHandsOver) {
  build({.up = "delay 10ms", .down = "delay 30ms"});
  connect();
  ASSERT_TRUE(session_->connected());
  tick_for(1s);
  const Handshake& handshake = session_->handshake();
  EXPECT_EQ(handshake.took, 40ms);
  EXPECT_EQ(handshake.hellos, 1U);
  EXPECT_EQ(handshake.sessions, 1U);
  EXPECT_EQ(handshake.scene, "sphere");
  EXPECT_THAT(handshake.simulated, HasSubstr("ball"));
  EXPECT_EQ(handshake.server_parts, wire::ServerParts::none);
  EXPECT_GT(handshake.pieces_offered, 0U);
  EXPECT_GE(session_->pieces_received(), handshake.pieces_offered) << "each is sent again until it is acknowledged";
  EXPECT_GT(session_->piece_bytes(), 0U);
}

TEST_F(DoctorSessionTest, AcknowledgesPiecesSoThatTheServerEndsSendingThem) {
  build({.up = "delay 5ms", .down = "delay 5ms", .scene = "dome"});
  connect();
  tick_for(10s);
  const std::uint64_t received = session_->pieces_received();
  EXPECT_GE(received, session_->handshake().pieces_offered);
  tick_for(2s);
  EXPECT_EQ(session_->pieces_received(), received);
}

TEST_F(DoctorSessionTest, MeasuresRoundTripsAndTheClocksOffsetToHalfTheDifferenceOfTheWays) {
  build({.up = "delay 10ms", .down = "delay 30ms", .server_clock = {.offset = 100s}});
  connect();
  tick_for(2s);
  const client::ClockOffset clocks = session_->clocks();
  EXPECT_LT(std::chrono::abs(clocks.ahead() - (100s - 10ms)), 1us);
  EXPECT_GE(clocks.uncertainty(clock_.now()), 20ms);
  const NetworkFindings found = findings();
  EXPECT_NEAR(found.round_trip.p50_ms, 40, 1e-6);
  EXPECT_NEAR(found.round_trip.max_ms, 40, 1e-6);
  EXPECT_EQ(found.up.sent, 2000U);
  EXPECT_EQ(found.up.lost + found.down.lost + found.unanswered, 0U);
  EXPECT_NEAR(found.up.above_least.max_ms, 0, 1e-6);
}

TEST_F(DoctorSessionTest, FindsTheDriftOfTheServersClock) {
  build({.up = "delay 10ms", .down = "delay 30ms", .server_clock = {.offset = 3s, .rate_error = 50e-6}});
  connect();
  tick_for(5s);
  const NetworkFindings found = findings();
  ASSERT_TRUE(found.drift);
  EXPECT_NEAR(found.drift->ppm, 50, 0.1);
  EXPECT_LT(found.drift->uncertain_ppm, 5);
}

TEST_F(DoctorSessionTest, CountsLossesOfEachDirectionAsBothEndsTogetherKnowThem) {
  for (const bool up : {true, false}) {
    SCOPED_TRACE(up ? "up" : "down");
    build({.up = up ? "delay 20ms loss 20%" : "delay 20ms", .down = up ? "delay 20ms" : "delay 20ms loss 20%"});
    connect();
    ASSERT_TRUE(session_->connected());
    tick_for(3s);
    const NetworkFindings found = findings();
    EXPECT_EQ(found.up.sent, 3000U);
    EXPECT_EQ(found.up.sent - found.up.lost, server_->counters().motions_received);
    EXPECT_EQ(found.down.sent, server_->counters().forces_sent);
    EXPECT_EQ(found.down.sent - found.down.lost, found.round_trip.count);
    EXPECT_NEAR(found.up.loss(), up ? 0.2 : 0, 0.04);
    EXPECT_NEAR(found.down.loss(), up ? 0 : 0.2, 0.04);
  }
}

TEST_F(DoctorSessionTest, CountsReorderingInTheDirectionInWhichItHappens) {
  build({.up = "delay 20ms reorder 25%", .down = "delay 20ms"});
  connect();
  tick_for(1s);
  const NetworkFindings found = findings();
  EXPECT_GT(found.up.reordered, 100U);
  EXPECT_EQ(found.down.reordered, 0U);
  EXPECT_EQ(found.up.lost, 0U);
  EXPECT_EQ(found.unanswered, found.up.reordered) << "the server answers the newest motion alone";
}

TEST_F(DoctorSessionTest, SeesHowLongNoForceComes) {
  build({.up = "delay 5ms", .down = "delay 5ms"});
  connect();
  tick_for(1s);
  EXPECT_LE(session_->longest_gap(), 2ms);
  network_->set_blackhole(sim::Direction::down, true);
  tick_for(400ms);
  EXPECT_GE(session_->longest_gap(), 380ms) << "the present one counts";
  network_->set_blackhole(sim::Direction::down, false);
  tick_for(1s);
  const NetworkFindings found = findings();
  EXPECT_NEAR(found.longest_gap_ms, 401, 2);
  EXPECT_EQ(found.down.lost, 400U);
}

TEST_F(DoctorSessionTest, PassesOnWhyTheServerRefuses) {
  build({.scene = "circle"});
  connect();
  EXPECT_FALSE(session_->connected());
  EXPECT_EQ(session_->handshake().refused_for, wire::RefusalReason::wrong_degrees_of_freedom);
  EXPECT_THAT(session_->handshake().refusal, HasSubstr("degrees of freedom"));
  build({.scene = "circle", .degrees_of_freedom = 2});
  connect();
  EXPECT_TRUE(session_->connected());
}

TEST_F(DoctorSessionTest, IsAnsweredToMotionsInDatagramsOfAnySize) {
  build({.up = "delay 5ms", .down = "delay 5ms"});
  connect();
  ASSERT_TRUE(session_->connected());
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{256}, std::size_t{700}, wire::kFrameBytesMax}) {
    SCOPED_TRACE(bytes);
    const std::uint64_t motion = session_->send_motion(bytes);
    ASSERT_NE(motion, 0U);
    EXPECT_FALSE(session_->is_answered_since(motion));
    live_until(clock_.now() + 20ms);
    session_->receive();
    EXPECT_TRUE(session_->is_answered_since(motion));
  }
  EXPECT_EQ(session_->send_motion(wire::kFrameBytesMax + 1), 0U) << "no server would take it";
  const NetworkFindings found = findings();
  EXPECT_EQ(found.up.sent, 4U);
  EXPECT_EQ(found.up.lost, 0U);
}

TEST_F(DoctorSessionTest, CountsASessionThatTheServerEndedAndTheOneAfter) {
  build({.up = "delay 5ms", .down = "delay 5ms"});
  connect();
  tick_for(1s);
  server_->stop();
  tick_for(2s);
  EXPECT_EQ(session_->handshake().sessions, 2U);
  EXPECT_TRUE(session_->connected());
}

TEST_F(DoctorSessionTest, DoesNotAllocateInATickWithAnAnswer) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  constexpr net::Address kFar{.ip = {}, .port = 47800};
  wire::Codec far;
  test::FakeLink link;
  test::FakeClock clock;
  clock.time = 1s;
  DoctorSession session({.server = kFar, .answers = 100}, link, clock);
  session.keep_connected();
  ASSERT_FALSE(link.sent.empty());
  const auto hello = std::get<wire::Hello>(std::get<wire::Message>(far.decode(link.sent.back().bytes))).client_nonce;
  link.arrive(far.encode(wire::Welcome{.client_nonce = hello, .session = 7}), kFar);
  session.receive();
  ASSERT_TRUE(session.connected());
  link.keep = false;
  link.reserve(100);
  for (std::uint64_t i = 1; i <= 50; ++i) {
    wire::EnvironmentForce force{.session = 7,
                                 .sequence = i,
                                 .motion_sequence = i,
                                 .motion_device_time = clock.time,
                                 .server_receive_time = clock.time,
                                 .server_send_time = clock.time,
                                 .motions_received = i};
    force.answer.force = control::Vector::Zero(3);
    force.position = control::Vector::Zero(3);
    // It comes before the tick asks: the tick sends the motion, then takes the answer in.
    link.arrive_again(far.encode(force), kFar);
    const test::AllocationGuard guard;
    session.tick();
    EXPECT_EQ(guard.heap_operations(), 0U);
    clock.time += 1ms;
  }
  EXPECT_EQ(session.answers().size(), 50U);
}

}  // namespace
}  // namespace forcebound::client::commands
