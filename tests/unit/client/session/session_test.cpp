#include "forcebound/client/session/session.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

TEST_F(SessionTest, AppliesZeroForceBeforeTheFirstAnswer) {
  for (int i = 0; i < 50; ++i) tick();
  EXPECT_EQ(device.applied, Vector::Zero(1));
  EXPECT_EQ(sent<wire::MotionSample>().size(), 0U);
  EXPECT_EQ(records.last.state, record::SessionState::connecting);
}

TEST_F(SessionTest, SendsEveryReadingAndAppliesTheAnswerOnTheNextTick) {
  connect();
  device.position[0] = 0.25;
  tick();
  const auto motions = sent<wire::MotionSample>();
  ASSERT_EQ(motions.size(), 1U);
  EXPECT_EQ(motions[0].position[0], 0.25);
  EXPECT_EQ(motions[0].device_time, clock.time);
  arrive(answer(motions[0], -2.5));
  tick();
  EXPECT_EQ(device.applied[0], -2.5);
  EXPECT_EQ(records.last.force_age, 1ms);
  EXPECT_EQ(records.last_force.round_trip, 1ms);
  EXPECT_EQ(records.last.displayed_N, 2.5);
}

TEST_F(SessionTest, SendsAndWritesDownWhatTheHandleHas) {
  connect();
  device.handle = {.buttons = 5, .gripper = 0.5, .orientation = {{0, 0, 1, 0}}};
  tick();
  EXPECT_EQ(sent<wire::MotionSample>().at(0).handle, device.handle);
  EXPECT_EQ(records.last.handle, device.handle);
  link.sent.clear();
  device.handle = {};
  tick();
  EXPECT_EQ(sent<wire::MotionSample>().at(0).handle, control::Handle{});
  EXPECT_EQ(records.last.handle, control::Handle{});
}

class SessionOfRareMotions : public SessionTest {
 protected:
  SessionOfRareMotions() : SessionTest("none", baselines::shipped_laws(), nullptr, {.most_Hz = 20}) {}
};

TEST_F(SessionOfRareMotions, SendsAMotionAtOnceWhenAButtonChanges) {
  device.handle.buttons = 0;
  connect();
  tick();
  link.sent.clear();
  for (int i = 0; i < 10; ++i) tick();
  EXPECT_EQ(sent<wire::MotionSample>().size(), 0U) << "one in 50 ms";
  device.handle.buttons = 1;
  tick();
  device.handle.buttons = 0;
  tick();
  tick();
  const auto motions = sent<wire::MotionSample>();
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_TRUE(motions[0].handle.pressed(0));
  EXPECT_FALSE(motions[1].handle.pressed(0));
}

TEST_F(SessionTest, OfAReadingThatFailedTheHandleCountsNoMore) {
  connect();
  device.handle = {.buttons = 5};
  device.status = device::Reading::Status::failed;
  tick();
  EXPECT_EQ(records.last.handle, control::Handle{});
}

TEST_F(SessionTest, RendersTheTextureOfAnOldAnswerWhereTheDeviceIsNow) {
  connect();
  device.position = Vector::Constant(1, 0.001);
  tick();
  auto force = answer(sent<wire::MotionSample>().back(), -2);
  force.answer.texture_N = 0.5;
  force.answer.texture_wave = Vector::Constant(1, 1000);
  arrive(force);
  for (const double x : {0.001, 0.0015, 0.002}) {
    device.position = Vector::Constant(1, x);
    tick();
    EXPECT_NEAR(device.applied[0], -2 - 0.5 * std::sin(1000 * x), 1e-12);
  }
}

TEST_F(SessionTest, ExcludesTheWaitForTheTickFromTheRoundTrip) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.5));
  link.waited = 700us;
  tick();
  EXPECT_EQ(records.last_force.round_trip, 300us);
  EXPECT_EQ(records.last.force_age, 1ms);
}

TEST_F(SessionTest, HoldsTheForceThenFadesItThenDropsIt) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.0));
  tick();
  for (int i = 0; i < 249; ++i) tick();
  EXPECT_EQ(device.applied[0], -2.0);
  for (int i = 0; i < 375; ++i) tick();
  EXPECT_NEAR(device.applied[0], -1.0, 1e-12);
  for (int i = 0; i < 376; ++i) tick();
  EXPECT_EQ(device.applied[0], 0.0);
  EXPECT_EQ(records.last.policy, record::ForcePolicy::dropped);
  EXPECT_EQ(session.state(), SessionState::reconnecting);
  using K = Event::Kind;
  EXPECT_EQ(events.kinds, (std::vector{K::welcomed, K::force_fading, K::force_dropped}));
}

TEST_F(SessionTest, TakesTheForceForTheNewestMotionWhateverTheOrderOfArrival) {
  connect();
  for (int i = 0; i < 3; ++i) tick();
  const auto motions = sent<wire::MotionSample>();
  arrive(answer(motions.at(2), -3));
  arrive(answer(motions.at(1), -2));
  tick();
  EXPECT_EQ(device.applied[0], -3);
  EXPECT_EQ(records.forces, 2) << "the late one is written down all the same";
  EXPECT_EQ(session.totals().reordered, 1U);
}

TEST_F(SessionTest, GetsAnotherSessionFromAServerThatRestarted) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.0));
  tick();
  arrive(wire::Refusal{.session = kSession, .reason = wire::RefusalReason::unknown_session});
  tick();
  EXPECT_EQ(device.applied[0], -2.0) << "the force does not jump";
  const auto hellos = sent<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession + 1});
  tick();
  tick();
  const auto motions = sent<wire::MotionSample>();
  ASSERT_FALSE(motions.empty());
  EXPECT_EQ(motions.back().session, kSession + 1);
  EXPECT_EQ(session.totals().reconnects, 1U);
}

TEST_F(SessionTest, WellFormedButFalseForcesNeverReachTheDevice) {
  connect();
  tick();
  const auto motion = sent<wire::MotionSample>().at(0);
  std::mt19937_64 random(7);
  constexpr std::array<std::int64_t, 6> kTimes{0, 1, -1, INT64_MAX, INT64_MIN, 1'000'000};
  const auto time = [&] { return Nanoseconds{kTimes[random() % kTimes.size()]}; };
  for (int i = 0; i < 5000; ++i) {
    auto force = answer(motion, -1);
    // Each false value alone must be enough.
    switch (i % 7) {
      case 0:
        force.session ^= std::uint64_t{1} << random() % 64;
        break;
      case 1:
        force.motion_sequence += 1 + random() % (std::uint64_t{1} << 63);
        break;
      case 2:
        force.motion_device_time += Nanoseconds{1 + static_cast<std::int64_t>(random() % 1000)};
        break;
      case 3:
        force.answer.force = Vector::Constant(2 + static_cast<int>(random() % 5), -1.0);
        break;
      case 4:
        force.server_receive_time = Nanoseconds{5};
        force.server_send_time = Nanoseconds{4};
        break;
      case 5:
        force.answer.contact_normal = Vector::Constant(1, 1e200);
        break;
      default:
        force.compute_time = std::max(time(), Nanoseconds{1});
        break;
    }
    arrive(force);
    if (i % 32 == 0) tick();
  }
  for (int i = 0; i < 100; ++i) tick();
  EXPECT_EQ(records.forces, 0);
  EXPECT_EQ(device.applied[0], 0);
  EXPECT_EQ(session.totals().foreign_session + session.totals().malformed[wire::Malformed::unreadable], 5000U);
}

TEST_F(SessionTest, AFailedReadingIsZeroForceAndNoMotion) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.0));
  tick();
  link.sent.clear();
  device.position[0] = std::numeric_limits<double>::quiet_NaN();
  tick();
  EXPECT_EQ(device.applied[0], 0);
  EXPECT_EQ(sent<wire::MotionSample>().size(), 0U);
  EXPECT_EQ(session.totals().readings[control::ReadingStatus::incomplete], 1U);
  device.position[0] = 0;
  tick();
  EXPECT_EQ(device.applied[0], -2.0);
}

TEST_F(SessionTest, ClosesWithZeroForceWhenTheServersCountsNoLongerChange) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.0));
  tick();
  ASSERT_EQ(device.applied[0], -2.0);
  bool closed = false;
  int byes = 0;
  for (int ms = 0; ms < 1000 && !closed; ++ms) {
    clock.time += 1ms;
    closed = session.close(clock.time);
    for (const auto& bye : sent<wire::Bye>()) {
      ++byes;
      arrive(wire::Bye{.session = bye.session, .motions_received = 2, .forces_sent = 2});
    }
  }
  EXPECT_TRUE(closed);
  EXPECT_GE(byes, 5);
  EXPECT_EQ(device.applied[0], 0);
  EXPECT_EQ(session.totals().lost_down, 1U);
}

TEST_F(SessionTest, TickDoesNotAllocateInTheWholeLifeOfASession) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  // An identical session, run first, gives the server's messages.
  connect();
  tick();
  const auto motion = sent<wire::MotionSample>().at(0);
  const auto prepare = [&](const wire::Message& message) {
    const auto bytes = codec.encode(message);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  };
  const auto force = prepare(answer(motion, -1));
  const auto unknown = prepare(wire::Refusal{.session = kSession, .reason = wire::RefusalReason::unknown_session});
  const auto bye = prepare(wire::Bye{.session = kSession});
  link.reserve(100);
  events.kinds.reserve(100);
  link.keep = false;
  const test::AllocationGuard guard;
  link.arrive_again(force, kServer);
  link.arrive_again(force, kServer);
  for (int i = 0; i < 1300; ++i) tick();  // fresh, fading, dropped, reconnecting
  device.position[0] = std::numeric_limits<double>::quiet_NaN();
  tick();
  device.position[0] = 0;
  device.released = clock.time + 100us;
  tick();
  link.arrive_again(unknown, kServer);
  for (int i = 0; i < 100; ++i) tick();
  link.arrive_again(bye, kServer);
  for (int i = 0; i < 10; ++i) {
    clock.time += 1ms;
    (void)session.close(clock.time);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST_F(SessionTest, GivesZeroForceOnAReadingThatFailed) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().back(), -2.0));
  tick();
  ASSERT_EQ(device.applied[0], -2.0);
  device.status = device::Reading::Status::failed;
  link.sent.clear();
  tick();
  EXPECT_EQ(device.applied[0], 0.0);
  EXPECT_EQ(session.totals().readings[control::ReadingStatus::failed], 1U);
  EXPECT_EQ(sent<wire::MotionSample>().size(), 0U) << "nobody knows where the device is";
}

TEST_F(SessionTest, ATickWithoutANewReadingReceivesButSendsAndRecordsNothing) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().back(), -2.0));
  device.status = device::Reading::Status::stale;
  tick();
  EXPECT_EQ(records.forces, 1);
  EXPECT_EQ(records.last.tick, session.ticks());
  EXPECT_LT(records.last.time, clock.time);
  EXPECT_EQ(sent<wire::MotionSample>().size(), 0U);
}

TEST_F(SessionTest, TakesTheTimeOfAReadingFromTheDeviceThatLatchedIt) {
  connect();
  device.latched_before = 300us;
  tick();
  EXPECT_EQ(sent<wire::MotionSample>().at(0).device_time, clock.time - 300us);
  EXPECT_EQ(records.last.time, clock.time - 300us);
  EXPECT_EQ(records.last.interval, 700us);
  EXPECT_EQ(records.last.latency, 300us);
}

TEST_F(SessionTest, RandomDatagramsNeverReachTheDevice) {
  connect();
  std::mt19937_64 random(20151);
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::byte> noise(random() % 200);
    for (auto& byte : noise) byte = static_cast<std::byte>(random());
    if (noise.size() > 2 && i % 2 == 0) {
      noise[0] = std::byte{'F'};
      noise[1] = std::byte{'B'};
    }
    link.arrive(noise, kServer);
    if (i % 32 == 0) tick();
  }
  EXPECT_EQ(device.applied[0], 0);
  EXPECT_EQ(records.forces, 0);
}

class Views final : public ViewSink {
 public:
  void on_view(const wire::ViewPiece& piece) noexcept override {
    last = piece.number;
    ++pieces;
  }
  int pieces = 0;
  std::uint32_t last = 0;
};

TEST_F(SessionTest, AsksHowTheSceneLooksOnlyForSomebodyWhoShowsIt) {
  tick();
  EXPECT_FALSE(sent<wire::Hello>().at(0).shows_scene);
  Views views;
  Session showing({.server = kServer, .scene = "wall"}, device, baselines::shipped_laws().make("none", device.facts()),
                  link, clock, {.ticks = sinks, .events = &events, .view = &views});
  showing.tick(clock.time += 1ms);
  const auto hello = sent<wire::Hello>().at(0);
  EXPECT_TRUE(hello.shows_scene);
  arrive(wire::Welcome{.client_nonce = hello.client_nonce, .session = kSession});
  showing.tick(clock.time += 1ms);
  arrive(wire::ViewPiece{.session = kSession, .view = 1, .pieces = 3, .number = 2});
  arrive(wire::ViewPiece{.session = kSession + 1, .view = 1, .pieces = 3, .number = 1});
  arrive(wire::ViewPiece{.session = kSession, .view = 1, .pieces = 3, .number = 1}, kOtherAddress);
  showing.tick(clock.time += 1ms);
  EXPECT_EQ(views.pieces, 1);
  EXPECT_EQ(views.last, 2U);
}

}  // namespace
}  // namespace forcebound::client
