#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

device::DeviceDescription arm_with(const device::Safety& safety) {
  device::DeviceDescription arm = device::load_device("arm-6dof");
  arm.safety = safety;
  return arm;
}

/// A session of a device that shows torques; the test plays the server.
class SessionOfSixAxes : public ::testing::Test {
 protected:
  explicit SessionOfSixAxes(std::string_view law = "none", double torque_slew_N_m_per_s = 0,
                            const device::Safety& safety = {})
      : device(arm_with(safety), device::make_operator("press:from_m=0,to_m=0,turn_y_rad=0.4,turn_Hz=2", 3, true)),
        session({.server = kServer, .torque_slew_N_m_per_s = torque_slew_N_m_per_s}, device,
                baselines::shipped_laws().make(law, device.facts()), link, clock, {.ticks = sinks, .events = &events}) {
  }

  void tick() {
    clock.time += 1ms;
    session.tick(clock.time);
  }

  /// The last of its kind.
  template <typename Message>
  Message newest_sent() {
    Message newest;
    for (const auto& datagram : link.sent) {
      const auto decoded = codec.decode(datagram.bytes);
      const auto& message = std::get<wire::Message>(decoded);
      if (std::holds_alternative<Message>(message)) newest = std::get<Message>(message);
    }
    link.sent.clear();
    return newest;
  }

  wire::Hello connect(const control::Vector& tool_m = {}) {
    tick();
    const auto hello = newest_sent<wire::Hello>();
    link.arrive(codec.encode(wire::Welcome{
                    .client_nonce = hello.client_nonce, .session = kSession, .simulated = "a tie", .tool_m = tool_m}),
                kServer);
    tick();
    return hello;
  }

  /// Of the motion sent last.
  wire::EnvironmentForce answer(const Eigen::Vector3d& force_N, const Vector& torque_N_m) {
    const auto motion = newest_sent<wire::MotionSample>();
    wire::EnvironmentForce force;
    force.session = kSession;
    force.sequence = ++force_sequence;
    force.motion_sequence = motion.sequence;
    force.motion_device_time = motion.device_time;
    force.answer.force = force_N;
    force.answer.torque_N_m = torque_N_m;
    force.position = motion.position;
    force.motions_received = std::max(motion.sequence, force_sequence);
    return force;
  }

  /// With a tool in the hand, and an answer with force and torque before so many ticks.
  std::uint64_t heap_operations_of(int ticks) {
    connect(Eigen::Vector3d(0, 0.02, -0.1));
    tick();
    const auto bytes = codec.encode(answer({1, 0, -1}, Eigen::Vector3d(0.1, 0, 0.1)));
    const std::vector<std::byte> force(bytes.begin(), bytes.end());
    link.reserve(100);
    events.kinds.reserve(100);
    events.words.reserve(1000);
    link.keep = false;
    const test::AllocationGuard guard;
    link.arrive_again(force, kServer);
    for (int i = 0; i < ticks; ++i) tick();
    return guard.heap_operations();
  }

  device::SimulatedDevice device;
  test::FakeLink link;
  test::FakeClock clock;
  LastRecord records;
  Events events;
  std::array<record::TickSink*, 1> sinks{&records};
  wire::Codec codec;
  std::uint64_t force_sequence = 0;
  Session session;
};

TEST_F(SessionOfSixAxes, AsksForTorqueAndTellsItsOrientationBesideThreeTranslations) {
  const wire::Hello hello = connect();
  EXPECT_EQ(hello.degrees_of_freedom, 3U);
  EXPECT_TRUE(hello.shows_torque);
  tick();
  const auto motion = newest_sent<wire::MotionSample>();
  EXPECT_EQ(motion.position.rows(), 3);
  EXPECT_TRUE(motion.handle.orientation.has_value());
  EXPECT_EQ(std::ranges::count(events.kinds, Event::Kind::no_torque), 0);
}

TEST_F(SessionOfSixAxes, ShowsTheTorqueOfTheAnswer) {
  connect();
  tick();
  const Eigen::Vector3d torque_N_m(0.1, -0.05, 0.02);
  link.arrive(codec.encode(answer({0.5, 0, -1}, torque_N_m)), kServer);
  tick();
  EXPECT_LT((records.last.applied - Eigen::Vector3d(0.5, 0, -1)).norm(), 1e-12);
  ASSERT_EQ(records.last.applied_torque_N_m.rows(), 3);
  EXPECT_LT((records.last.applied_torque_N_m - torque_N_m).norm(), 1e-12);
}

TEST_F(SessionOfSixAxes, RefusesATorqueThatHasNotThreeRows) {
  connect();
  tick();
  link.arrive(codec.encode(answer({0.5, 0, -1}, Vector::Ones(2))), kServer);
  tick();
  EXPECT_TRUE(records.last.applied.isZero(0));
}

TEST_F(SessionOfSixAxes, AToolTouchesWithItsTipAndTurnsTheHandle) {
  const Eigen::Vector3d lever_m(0, 0, -0.1);
  connect(lever_m);
  for (int i = 0; i < 300; ++i) tick();
  const auto motion = newest_sent<wire::MotionSample>();
  const Eigen::Vector3d arm_m = control::quaternion_of(*motion.handle.orientation) * lever_m;
  EXPECT_GT(std::abs(arm_m.x()), 1e-3) << "or it did not turn";
  EXPECT_LT((motion.position - records.last.position - arm_m).norm(), 1e-7) << "the place is the tip's";
  tick();
  const Eigen::Vector3d force_N(1, 0.5, 0);
  link.arrive(codec.encode(answer(force_N, {})), kServer);
  tick();
  const Eigen::Vector3d now_m = control::quaternion_of(*records.last.handle.orientation) * lever_m;
  EXPECT_LT((records.last.request_torque_N_m - now_m.cross(force_N)).norm(), 1e-12);
  EXPECT_LT((records.last.applied_torque_N_m - now_m.cross(force_N)).norm(), 1e-12);
}

class SessionOfSixAxesWithARateLimiter : public SessionOfSixAxes {
 protected:
  SessionOfSixAxesWithARateLimiter() : SessionOfSixAxes("none", 20) {}
};

TEST_F(SessionOfSixAxesWithARateLimiter, ATorqueThatJumpsIsFollowedAtTheBound) {
  connect();
  tick();
  link.arrive(codec.encode(answer({0.5, 0, -1}, Eigen::Vector3d(0.09, 0, 0))), kServer);
  tick();
  double before_N_m = records.last.applied_torque_N_m.x();
  EXPECT_LE(before_N_m, 0.0201);
  for (int i = 0; i < 10; ++i) {
    tick();
    const double now_N_m = records.last.applied_torque_N_m.x();
    EXPECT_LE(now_N_m - before_N_m, 0.0201);
    before_N_m = now_N_m;
  }
  EXPECT_NEAR(before_N_m, 0.09, 1e-12);
  EXPECT_LT((records.last.applied - Eigen::Vector3d(0.5, 0, -1)).norm(), 1e-12) << "the force has a bound of its own";
  EXPECT_EQ(session.totals().torque_slew_bounded, 4U);
  EXPECT_EQ(session.totals().slew_bounded, 0U);
}

TEST_F(SessionOfSixAxesWithARateLimiter, TheTorqueOfAForceAtTheToolIsBoundedAsWell) {
  connect(Eigen::Vector3d(0, 0, -0.1));
  tick();
  link.arrive(codec.encode(answer({2, 0, 0}, {})), kServer);
  tick();
  EXPECT_LE(records.last.request_torque_N_m.norm(), 0.0201) << "0.2 N m are asked for";
  for (int i = 0; i < 12; ++i) tick();
  EXPECT_GT(records.last.request_torque_N_m.norm(), 0.15);
  EXPECT_GT(session.totals().torque_slew_bounded, 5U);
}

class SessionOfSixAxesWithASlowRateLimiter : public SessionOfSixAxes {
 protected:
  SessionOfSixAxesWithASlowRateLimiter() : SessionOfSixAxes("none", 0.1) {}
};

TEST_F(SessionOfSixAxesWithASlowRateLimiter, ATorqueBeginsAtZeroAfterTheServerWasSilent) {
  connect();
  for (int i = 0; i < 2100; ++i) {
    tick();
    link.arrive(codec.encode(answer({0, 0, 0}, Eigen::Vector3d(0.2, 0, 0))), kServer);
  }
  tick();
  EXPECT_NEAR(records.last.applied_torque_N_m.x(), 0.2, 1e-9);
  for (int i = 0; i < 1100; ++i) tick();
  EXPECT_TRUE(records.last.applied_torque_N_m.isZero(0))
      << "dropped, though the bound would take 2 s from there to zero";
  link.arrive(codec.encode(answer({0, 0, 0}, Eigen::Vector3d(0.2, 0, 0))), kServer);
  tick();
  EXPECT_LE(records.last.applied_torque_N_m.x(), 0.00011);
  EXPECT_GT(records.last.applied_torque_N_m.x(), 0);
}

class SessionOfSixAxesThatTurnTooFast : public SessionOfSixAxes {
 protected:
  // The hand turns by up to 0.4 rad at 2 Hz, gently at first.
  SessionOfSixAxesThatTurnTooFast() : SessionOfSixAxes("fba-exact", 20, {.ramp_s = 0.01, .turn_rad_per_s_max = 1.5}) {}
};

TEST_F(SessionOfSixAxesThatTurnTooFast, HasNoTorqueThenAndSaysWhy) {
  connect();
  std::uint64_t without = 0;
  for (int i = 0; i < 1000; ++i) {
    tick();
    link.arrive(codec.encode(answer({1, 0, -1}, Eigen::Vector3d(0.1, 0, 0.1))), kServer);
    without += records.last.request_torque_N_m.isZero(0);
  }
  const record::RunTotals totals = session.totals();
  EXPECT_GE(totals.trips_of_turn, 1U);
  EXPECT_EQ(totals.trips_of_speed, 0U);
  EXPECT_GT(without, 50U);
  EXPECT_LT(without, 900U) << "it turns slowly at the ends of its way";
  EXPECT_EQ(std::ranges::count(events.kinds, Event::Kind::limited_for_safety),
            static_cast<std::ptrdiff_t>(totals.trips_of_turn));
}

TEST_F(SessionOfSixAxesThatTurnTooFast, TicksWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  EXPECT_EQ(heap_operations_of(1000), 0U);
  EXPECT_GE(session.totals().torque_slew_bounded, 1U);
  EXPECT_GE(session.totals().trips_of_turn, 1U);
}

class SessionOfSixAxesWithTheExactLaw : public SessionOfSixAxes {
 protected:
  SessionOfSixAxesWithTheExactLaw() : SessionOfSixAxes("fba-exact") {}
};

TEST_F(SessionOfSixAxesWithTheExactLaw, TicksWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  EXPECT_EQ(heap_operations_of(300), 0U);
}

TEST_F(SessionOfSixAxesWithTheExactLaw, IsPassiveWhateverTorqueIsAskedFor) {
  connect(Eigen::Vector3d(0, 0, -0.1));
  double shown_N_m = 0;
  for (int i = 0; i < 1500; ++i) {
    tick();
    const double wild = (i / 40) % 2 == 0 ? 1 : -1;
    link.arrive(codec.encode(answer({5 * wild, 0, 2}, Eigen::Vector3d(0, wild, -wild))), kServer);
    tick();
    shown_N_m = std::max(shown_N_m, records.last.applied_torque_N_m.norm());
  }
  EXPECT_GT(shown_N_m, 0.02);
  EXPECT_GE(records.last.audit_minimum_J, -1e-9);
}

}  // namespace
}  // namespace forcebound::client
