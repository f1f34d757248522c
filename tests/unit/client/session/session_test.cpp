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

TEST_F(SessionTest, GivesTheDepthOnlyNearTheAnswersPosition) {
  connect();
  device.position[0] = 0.25;
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.5));  // 1 mm deep there, normal -x
  tick();
  EXPECT_TRUE(records.last.contact);
  EXPECT_NEAR(records.last.penetration_m, 1e-3, 1e-12);
  device.position[0] = 0.2505;
  tick();
  EXPECT_NEAR(records.last.penetration_m, 1.5e-3, 1e-12) << "0.5 mm deeper";
  device.position[0] = 0.2521;
  tick();
  EXPECT_TRUE(std::isnan(records.last.penetration_m)) << "2.1 mm away: the surface may have turned";
  EXPECT_TRUE(records.last.contact) << "as the newest answer says";
  device.position[0] = 0.2485;
  tick();
  EXPECT_TRUE(std::isnan(records.last.penetration_m));
}

TEST_F(SessionTest, GivesNoDepthBeforeTheFirstAnswer) {
  connect();
  tick();
  EXPECT_FALSE(records.last.contact);
  EXPECT_TRUE(std::isnan(records.last.penetration_m));
}

TEST_F(SessionTest, RendersTheTextureOfAnOldAnswerWhereTheDeviceIsNow) {
  connect();
  device.position = Vector::Constant(1, 0.001);
  tick();
  auto force = answer(sent<wire::MotionSample>().back(), -2);
  force.texture_N = 0.5;
  force.texture_wave = Vector::Constant(1, 1000);
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

TEST_F(SessionTest, CountsTheTimeWithoutFreshForcesFromTheHoldTimeThoughItSlept) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.0));
  tick();
  clock.time += 2s;
  tick();
  ASSERT_EQ(events.kinds.back(), Event::Kind::force_dropped);
  EXPECT_EQ(events.duration, 2s + 2ms) << "its age";
  arrive(answer(sent<wire::MotionSample>().back(), -2.0));
  tick();
  ASSERT_EQ(events.kinds.back(), Event::Kind::force_fresh);
  EXPECT_EQ(events.duration, 2s + 3ms - 250ms);
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

TEST_F(SessionTest, CountsRejectedDatagramsByReason) {
  connect();
  tick();
  const auto motion = sent<wire::MotionSample>().at(0);
  arrive(answer(motion, -1), kOtherAddress);
  auto other = answer(motion, -1);
  other.session = kSession + 1;
  arrive(other);
  const std::array<std::byte, 3> noise{};
  link.arrive(noise, kServer);
  arrive(wire::MotionSample{.session = kSession, .sequence = 1, .position = Vector::Zero(1)});
  tick();
  EXPECT_EQ(device.applied[0], 0);
  const auto totals = session.totals();
  EXPECT_EQ(totals.foreign_session, 2U);
  EXPECT_EQ(totals.malformed[static_cast<std::size_t>(wire::Malformed::truncated)], 1U);
  EXPECT_EQ(totals.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)], 1U);
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

TEST_F(SessionTest, SaysWhichEndToUpdateWhenTheServerSpeaksAnotherVersion) {
  tick();
  wire::Refusal refusal{.client_nonce = sent<wire::Hello>().at(0).client_nonce,
                        .reason = wire::RefusalReason::version_mismatch,
                        .text = "this server speaks protocol version 1, the client 2"};
  arrive(refusal);  // version 1 says its version in the text alone
  tick();
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::refused}));
  EXPECT_EQ(events.words, "the server speaks protocol version 1, the client version 2: update the server");
  EXPECT_TRUE(session.refused());
  EXPECT_EQ(session.state(), SessionState::connecting);

  refusal.protocol_version = 3;
  arrive(refusal);
  tick();
  EXPECT_EQ(events.words, "the server speaks protocol version 3, the client version 2: update the client");
  EXPECT_EQ(session.totals().refusals, 2U);
  EXPECT_EQ(device.applied.norm(), 0);
}

TEST_F(SessionTest, ReplacesControlCharactersInTheServersText) {
  tick();
  const auto hellos = sent<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  arrive(wire::Refusal{.client_nonce = hellos[0].client_nonce, .text = "full\x1b[2J\nreally"});
  tick();
  EXPECT_EQ(events.words, "full?[2J?really");
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce,
                       .session = kSession,
                       .scene = "wa\tll",
                       .simulated = "\x1b]0;a wall\x07"});
  tick();
  EXPECT_EQ(events.words, "?]0;a wall?");
  EXPECT_EQ(session.totals().scene, "wa?ll");
  EXPECT_EQ(session.totals().simulated, "?]0;a wall?");
}

TEST_F(SessionTest, ACopyOfTheServersByeDoesNotEndTheNextSession) {
  connect();
  arrive(wire::Bye{.session = kSession});
  tick();
  const auto hellos = sent<wire::Hello>();
  ASSERT_EQ(hellos.size(), 1U);
  arrive(wire::Bye{.session = kSession});
  arrive(wire::Welcome{.client_nonce = hellos[0].client_nonce, .session = kSession + 1});
  tick();
  tick();
  EXPECT_EQ(session.state(), SessionState::active);
  EXPECT_EQ(sent<wire::MotionSample>().back().session, kSession + 1);
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
        force.force = Vector::Constant(2 + static_cast<int>(random() % 5), -1.0);
        break;
      case 4:
        force.server_receive_time = Nanoseconds{5};
        force.server_send_time = Nanoseconds{4};
        break;
      case 5:
        force.contact_normal = Vector::Constant(1, 1e200);
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
  EXPECT_EQ(session.totals().foreign_session +
                session.totals().malformed[static_cast<std::size_t>(wire::Malformed::unreadable)],
            5000U);
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

TEST_F(SessionTest, ALinkThatIsDownIsCountedAndHarmless) {
  connect();
  link.works = false;
  for (int i = 0; i < 10; ++i) tick();
  EXPECT_EQ(session.totals().send_failures, 10U);
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

TEST_F(SessionTest, WaitsOnCloseAsLongAsTheMostDelayedMotionWasLate) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().at(0), -2.0));
  for (int i = 0; i < 600; ++i) tick();
  const std::uint64_t motions = session.totals().sent;
  bool closed = false;
  int ms = 0;
  for (; ms < 2000 && !closed; ++ms) {
    clock.time += 1ms;
    closed = session.close(clock.time);
    // The last motion arrives 450 ms after all others; an earlier one was as late.
    const std::uint64_t received = ms < 450 ? motions - 1 : motions;
    for (const auto& bye : sent<wire::Bye>()) {
      arrive(wire::Bye{.session = bye.session, .motions_received = received, .forces_sent = 1, .motions_behind = 460});
    }
  }
  EXPECT_TRUE(closed);
  EXPECT_LT(ms, 1000);
  EXPECT_EQ(session.totals().lost_up, 0U);
  EXPECT_EQ(session.totals().in_flight, 0U);
}

TEST_F(SessionTest, CountsAReleaseByTheDevice) {
  connect();
  tick();
  device.released = clock.time + 500us;
  tick();
  EXPECT_EQ(session.totals().released_by_device, 1U);
}

TEST_F(SessionTest, CommandsThatMayNotHaveReachedTheMotorsAreCounted) {
  connect();
  tick();
  device.write_lost = true;
  tick();
  device.write_lost = false;
  tick();
  EXPECT_EQ(session.totals().failed_writes, 1U);
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

TEST_F(SessionTest, LeavesTheForceToTheDeviceWhileNoReadingIsNewButNotForLong) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().back(), -2.0));
  tick();
  ASSERT_EQ(device.applied[0], -2.0);
  const Nanoseconds applied_at = device.applied_at;
  link.sent.clear();
  device.status = device::Reading::Status::stale;
  for (int i = 1; i < 5; ++i) {
    tick();
    EXPECT_EQ(device.applied_at, applied_at) << i << " ms";
  }
  EXPECT_EQ(session.totals().stale_readings, 4U);
  EXPECT_EQ(session.totals().readings.refused(), 0U);
  EXPECT_EQ(sent<wire::MotionSample>().size(), 0U);
  tick();
  EXPECT_EQ(device.applied[0], 0.0) << "5 ms after the last command";
  EXPECT_EQ(session.totals().readings[control::ReadingStatus::stale], 1U);
}

TEST_F(SessionTest, LeavesAForceToADeviceThatNeverLetsGoOnlyIfTheNextTickIsInTime) {
  device.set_hold(2e-3, false);
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().back(), -2.0));
  tick();
  ASSERT_EQ(device.applied[0], -2.0);
  device.status = device::Reading::Status::stale;
  tick();
  EXPECT_EQ(device.applied[0], 0.0) << "another tick later would be 2 ms after the command";
}

TEST_F(SessionTest, AfterATickWithoutANewReadingTheNextIntervalIsLonger) {
  connect();
  tick();
  device.status = device::Reading::Status::stale;
  tick();
  device.status = device::Reading::Status::ok;
  tick();
  EXPECT_EQ(records.last.interval, 2ms);
}

TEST_F(SessionTest, TellsOnceWhenTheDeviceIsGoneAndWhenItIsBack) {
  connect();
  const std::size_t before = events.kinds.size();
  device.status = device::Reading::Status::failed;
  for (int i = 0; i < 20; ++i) tick();
  EXPECT_EQ(events.kinds.size(), before) << "a late reading is no news";
  for (int i = 0; i < 80; ++i) tick();
  ASSERT_EQ(events.kinds.size(), before + 1);
  EXPECT_EQ(events.kinds.back(), Event::Kind::device_gone);
  EXPECT_EQ(events.words, device.last_error());
  device.status = device::Reading::Status::ok;
  tick();
  ASSERT_EQ(events.kinds.size(), before + 2);
  EXPECT_EQ(events.kinds.back(), Event::Kind::device_back);
  EXPECT_EQ(events.duration, 101ms);
  tick();
  EXPECT_EQ(events.kinds.size(), before + 2);
}

TEST_F(SessionTest, OfADeviceThatComesAndGoesTellsOnce) {
  connect();
  tick();
  const std::size_t before = events.kinds.size();
  for (int i = 0; i < 10; ++i) {
    device.status = device::Reading::Status::failed;
    for (int k = 0; k < 30; ++k) tick();
    device.status = device::Reading::Status::ok;
    for (int k = 0; k < 20; ++k) tick();
  }
  EXPECT_EQ(events.kinds.size(), before + 2) << "gone and back, in half a second";
  device.status = device::Reading::Status::failed;
  for (int k = 0; k < 1100; ++k) tick();
  EXPECT_EQ(events.kinds.size(), before + 3);
  EXPECT_EQ(events.kinds.back(), Event::Kind::device_gone);
}

TEST_F(SessionTest, GivesZeroForceOnAReadingOfTheWrongSize) {
  connect();
  tick();
  arrive(answer(sent<wire::MotionSample>().back(), -2.0));
  device.position = Vector::Zero(3);
  tick();
  EXPECT_EQ(device.applied, Vector::Zero(1));
  EXPECT_EQ(session.totals().readings[control::ReadingStatus::incomplete], 1U);
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

TEST_F(SessionTest, RejectsAReadingFromTheFuture) {
  connect();
  device.latched_before = -1ms;
  tick();
  EXPECT_EQ(session.totals().readings[control::ReadingStatus::future], 1U);
  EXPECT_EQ(records.last.time, clock.time);
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

TEST_F(SessionTest, TellsOnceWhatTheRobotAtTheFarEndDoes) {
  connect();
  events.kinds.clear();
  const auto answer_with = [this](control::FollowerState state) {
    tick();
    wire::EnvironmentForce force = answer(sent<wire::MotionSample>().back(), 0);
    force.follower = state;
    arrive(force);
  };
  answer_with(control::FollowerState::waiting);
  answer_with(control::FollowerState::waiting);
  tick();
  ASSERT_EQ(events.kinds.size(), 1U);
  EXPECT_EQ(events.kinds[0], Event::Kind::follower_changed);
  EXPECT_EQ(events.follower, control::FollowerState::waiting);
  EXPECT_EQ(events.words, "keep the device still for a moment");
  device.handle.buttons = 0;
  answer_with(control::FollowerState::following);
  tick();
  EXPECT_EQ(events.kinds.size(), 2U);
  EXPECT_EQ(events.follower, control::FollowerState::following);
  EXPECT_EQ(events.words, "press and release the clutch") << "its device has buttons";
}

}  // namespace
}  // namespace forcebound::client
