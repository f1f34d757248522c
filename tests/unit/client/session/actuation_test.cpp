#include "forcebound/client/session/actuation.hpp"

#include <gtest/gtest.h>

#include "forcebound/control/transparent_law.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

/// The test asks for forces.
class ActuationTest : public ::testing::Test {
 protected:
  explicit ActuationTest(std::string_view law = "none", const control::LawRegistry& laws = baselines::shipped_laws())
      : actuation(device, laws.make(law, device.facts()), clock, reporter) {}

  /// None: the device holds the force of the tick before.
  std::optional<Actuation::Command> tick(double force_N = 0, bool silent = false) {
    clock.time += 1ms;
    const auto reading = actuation.read(clock.time);
    if (!reading) return std::nullopt;
    (void)actuation.begin_choosing(*reading);
    const Vector wanted_N = Vector::Constant(1, force_N);
    const Eigen::Vector3d no_torque_N_m = Eigen::Vector3d::Zero();
    return actuation.command(clock.time, *reading,
                             {.force_N = wanted_N, .torque_N_m = no_torque_N_m, .silent = silent});
  }

  [[nodiscard]] record::RunTotals totals() const {
    record::RunTotals totals;
    actuation.add_to(totals);
    return totals;
  }

  test::FakeDevice device{1};
  test::FakeClock clock;
  Events events;
  EventReporter reporter{&events};
  Actuation actuation;
};

TEST_F(ActuationTest, CommandsWhatIsAskedForUnlessNobodyAsks) {
  const auto asked = tick(-2);
  EXPECT_EQ(asked->request_N[0], -2);
  EXPECT_EQ(asked->applied_N[0], -2);
  EXPECT_EQ(device.applied[0], -2);
  const auto silent = tick(-2, true);
  EXPECT_EQ(silent->request_N[0], -2);
  EXPECT_EQ(silent->applied_N[0], 0);
  EXPECT_EQ(device.applied[0], 0);
}

class ActuationWithTheExactLaw : public ActuationTest {
 protected:
  ActuationWithTheExactLaw() : ActuationTest("fba-exact") {}
};

TEST_F(ActuationWithTheExactLaw, CommandsWhatTheLawLeaves) {
  tick();
  const auto command = tick(-2);
  EXPECT_EQ(command->request_N[0], -2);
  EXPECT_EQ(command->applied_N[0], 0) << "nothing was dissipated yet";
}

TEST_F(ActuationWithTheExactLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  events.kinds.reserve(10);
  const test::AllocationGuard guard;
  for (int i = 0; i < 10; ++i) tick(-2);
  device.status = device::Reading::Status::stale;
  for (int i = 0; i < 10; ++i) tick(-2);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST_F(ActuationTest, CountsAReleaseByTheDevice) {
  tick();
  device.released = clock.time + 500us;
  tick();
  EXPECT_EQ(totals().released_by_device, 1U);
}

TEST_F(ActuationTest, CommandsThatMayNotHaveReachedTheMotorsAreCounted) {
  tick();
  device.write_lost = true;
  tick();
  device.write_lost = false;
  tick();
  EXPECT_EQ(totals().failed_writes, 1U);
}

TEST_F(ActuationTest, LeavesTheForceToTheDeviceWhileNoReadingIsNewButNotForLong) {
  tick(-2);
  const Nanoseconds applied_at = device.applied_at;
  device.status = device::Reading::Status::stale;
  for (int i = 1; i < 5; ++i) {
    EXPECT_EQ(tick(-2), std::nullopt) << i << " ms";
    EXPECT_EQ(device.applied_at, applied_at);
  }
  EXPECT_EQ(totals().stale_readings, 4U);
  EXPECT_EQ(control::refused(totals().readings), 0U);
  tick(-2);
  EXPECT_EQ(device.applied[0], 0.0) << "5 ms after the last command";
  EXPECT_EQ(totals().readings[control::ReadingStatus::stale], 1U);
}

TEST_F(ActuationTest, LeavesAForceToADeviceThatNeverLetsGoOnlyIfTheNextTickIsInTime) {
  device.set_hold(2e-3, false);
  tick(-2);
  ASSERT_EQ(device.applied[0], -2.0);
  device.status = device::Reading::Status::stale;
  tick(-2);
  EXPECT_EQ(device.applied[0], 0.0) << "another tick later would be 2 ms after the command";
}

TEST_F(ActuationTest, AfterATickWithoutANewReadingTheNextIntervalIsLonger) {
  tick();
  device.status = device::Reading::Status::stale;
  tick();
  device.status = device::Reading::Status::ok;
  EXPECT_EQ(tick()->interval, 2ms);
}

TEST_F(ActuationTest, ReportsOnceThatTheDeviceIsGoneAndThatItIsBack) {
  device.status = device::Reading::Status::failed;
  for (int i = 0; i < 20; ++i) tick();
  EXPECT_TRUE(events.kinds.empty()) << "a late reading is no news";
  for (int i = 0; i < 80; ++i) tick();
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::device_gone}));
  EXPECT_EQ(events.words, device.last_error());
  device.status = device::Reading::Status::ok;
  tick();
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::device_gone, Event::Kind::device_back}));
  EXPECT_EQ(events.duration, 100ms);
  tick();
  EXPECT_EQ(events.kinds.size(), 2U);
}

TEST_F(ActuationTest, ReportsADeviceThatComesAndGoesOnce) {
  tick();
  for (int i = 0; i < 10; ++i) {
    device.status = device::Reading::Status::failed;
    for (int k = 0; k < 30; ++k) tick();
    device.status = device::Reading::Status::ok;
    for (int k = 0; k < 20; ++k) tick();
  }
  EXPECT_EQ(events.kinds.size(), 2U) << "gone and back, in half a second";
  device.status = device::Reading::Status::failed;
  for (int k = 0; k < 1100; ++k) tick();
  EXPECT_EQ(events.kinds.size(), 3U);
  EXPECT_EQ(events.kinds.back(), Event::Kind::device_gone);
}

TEST_F(ActuationTest, GivesZeroForceOnAReadingOfTheWrongSize) {
  tick(-2);
  device.position = Vector::Zero(3);
  tick(-2);
  EXPECT_EQ(device.applied, Vector::Zero(1));
  EXPECT_EQ(totals().readings[control::ReadingStatus::incomplete], 1U);
}

TEST_F(ActuationTest, RejectsAReadingFromTheFuture) {
  device.latched_before = -1ms;
  EXPECT_EQ(actuation.read(clock.time)->latched, clock.time);
  EXPECT_EQ(totals().readings[control::ReadingStatus::future], 1U);
}

TEST_F(ActuationTest, ReportsOnceThatADeviceThatTurnsWithoutMotorsShowsNoTorque) {
  device.handle.orientation = control::Handle::Orientation{1, 0, 0, 0};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(tick()->applied_torque_N_m.rows(), 0);
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::no_torque}));
  EXPECT_EQ(events.words, "fake");
}

struct WithNotedMotion {
  control::Motion noted;
};

/// No bound; notes what it is told.
class NotingLaw final : public control::PassivityLaw {
 public:
  NotingLaw(const control::DeviceFacts& facts, control::Motion& noted)
      : none_(facts.degrees_of_freedom(), facts.period_s), noted_(noted) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "noting"; }
  void credit(const control::Motion& motion) noexcept override { noted_ = motion; }
  void lose(const control::Motion& motion) noexcept override { noted_ = motion; }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override { return request_N; }
  void commit(const Vector& force_N) noexcept override { none_.commit(force_N); }
  [[nodiscard]] double energy_J() const noexcept override { return 0; }

 private:
  control::TransparentLaw none_;
  control::Motion& noted_;
};

control::LawRegistry laws_with_noting(control::Motion& noted) {
  control::LawRegistry laws = baselines::shipped_laws();
  laws.add({.name = "noting",
            .summary = "notes the motion",
            .make = [&noted](const control::DeviceFacts& facts, const control::LawOptions&) {
              return std::make_unique<NotingLaw>(facts, noted);
            }});
  return laws;
}

class ActuationOfADeviceThatReports : private WithNotedMotion, public ActuationTest {
 protected:
  ActuationOfADeviceThatReports() : ActuationTest("noting", laws_with_noting(noted)) { tick(); }

  /// What the law is told on the tick after, by a device that reports these times after the command.
  const control::Motion& told(std::optional<Nanoseconds> effective, std::optional<Nanoseconds> released = {}) {
    const Nanoseconds commanded = device.applied_at;
    if (effective) device.effective = commanded + *effective;
    if (released) device.released = commanded + *released;
    tick();
    return noted;
  }
};

TEST_F(ActuationOfADeviceThatReports, TellsTheLawWhenAForceTookEffect) {
  const control::Motion& motion = told(200us);
  EXPECT_NEAR(motion.effect_s, 200e-6, 1e-12);
  EXPECT_EQ(motion.latency_s, device.facts().latency_s) << "of the file";
}

TEST_F(ActuationOfADeviceThatReports, CountsTheTimeHeldFromTheEffectThatTheFactsExpect) {
  const control::Motion& motion = told(200us, 700us);
  EXPECT_NEAR(motion.held_s, 700e-6, 1e-12);
}

TEST_F(ActuationOfADeviceThatReports, CountsAnEffectBeforeItsCommand) {
  told(0us);
  EXPECT_EQ(totals().effects_outside_facts, 0U);
  told(-1us);
  EXPECT_EQ(totals().effects_outside_facts, 1U);
}

TEST_F(ActuationOfADeviceThatReports, CountsWhatItsFileDoesNotAllow) {
  told(200us, 700us);
  EXPECT_EQ(totals().effects_outside_facts, 1U) << "the file has no latency";
  EXPECT_EQ(totals().releases_outside_facts, 1U) << "and holds for 1 s";
}

}  // namespace
}  // namespace forcebound::client
