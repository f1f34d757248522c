#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/client/session/session.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_device.hpp"
#include "tests/support/fake_link.hpp"

namespace forcebound::client {

using namespace std::chrono_literals;
using control::Vector;

inline constexpr std::uint64_t kSession = 4711;
inline const net::Address kServer{.ip = {1}, .port = 47800};
inline const net::Address kOtherAddress{.ip = {2}, .port = 47800};

class LastRecord final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override { last = tick; }
  void on_force(const record::ForceRecord& force) noexcept override {
    last_force = force;
    ++forces;
  }
  record::TickRecord last;
  record::ForceRecord last_force;
  int forces = 0;
};

class Events final : public EventSink {
 public:
  void on_event(const Event& event) noexcept override {
    kinds.push_back(event.kind);
    words = event.words();
    duration = event.duration;
    follower = event.follower;
  }
  std::vector<Event::Kind> kinds;
  std::string words;                                               ///< of the last one
  Nanoseconds duration{0};                                         ///< of the last one
  control::FollowerState follower = control::FollowerState::none;  ///< likewise
};

/// The test plays the server: it inspects each motion and sends the answers itself.
class SessionTest : public ::testing::Test {
 protected:
  explicit SessionTest(std::string_view law = "none", const control::LawRegistry& laws = baselines::shipped_laws(),
                       LocalRendering* local = nullptr, SendRate rate = {})
      : session({.server = kServer, .scene = "wall", .local = local, .send_rate = rate}, device,
                laws.make(law, device.facts()), link, clock, {.ticks = sinks, .events = &events}) {}

  void tick() {
    clock.time += 1ms;
    session.tick(clock.time);
  }

  template <typename Message>
  std::vector<Message> sent() {
    std::vector<Message> messages;
    for (const auto& datagram : link.sent) {
      const auto decoded = codec.decode(datagram.bytes);
      const auto* message = std::get_if<wire::Message>(&decoded);
      if (message != nullptr && std::holds_alternative<Message>(*message))
        messages.push_back(std::get<Message>(*message));
    }
    link.sent.clear();
    return messages;
  }

  void arrive(const wire::Message& message, const net::Address& from = kServer) {
    link.arrive(codec.encode(message), from);
  }

  void connect() {
    tick();
    const auto hellos = sent<wire::Hello>();
    ASSERT_EQ(hellos.size(), 1U);
    arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession, .simulated = "a wall"});
    tick();
    ASSERT_EQ(session.state(), SessionState::active);
    link.sent.clear();
  }

  wire::EnvironmentForce answer(const wire::MotionSample& motion, double force_N) {
    wire::EnvironmentForce force;
    force.session = kSession;
    force.sequence = ++force_sequence;
    force.motion_sequence = motion.sequence;
    force.motion_device_time = motion.device_time;
    force.answer.force = Vector::Constant(1, force_N);
    force.position = motion.position;
    force.answer.contact_normal = Vector::Constant(1, -1.0);
    force.answer.penetration_m = 1e-3;
    force.motions_received = std::max(motion.sequence, force_sequence);  // no answer without a motion
    return force;
  }

  test::FakeDevice device{1};
  test::FakeLink link;
  test::FakeClock clock;
  LastRecord records;
  Events events;
  std::array<record::TickSink*, 1> sinks{&records};
  wire::Codec codec;
  std::uint64_t force_sequence = 0;
  Session session;
};

}  // namespace forcebound::client
