#include "forcebound/client/commands/doctor/doctor_verdict.hpp"

#include <gmock/gmock.h>

#include "forcebound/client/commands/doctor/felt_stiffness.hpp"
#include "tests/unit/client/commands/doctor/sound_findings.hpp"

namespace forcebound::client::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using Grade = DoctorVerdict::Grade;

TEST(DoctorVerdict, AsksForNoChangeWhereNothingIsWrong) {
  const DoctorVerdict verdict = doctor_verdict(sound_findings());
  EXPECT_THAT(verdict.changes, IsEmpty());
  EXPECT_EQ(verdict.network, Grade::good);
  EXPECT_EQ(verdict.machine, Grade::good);
  EXPECT_THAT(verdict.summary, AllOf(HasSubstr("network is good"), HasSubstr("machine good"), HasSubstr("0.3 ms")));
  EXPECT_THAT(verdict.scene, AllOf(HasSubstr("'sphere'"), HasSubstr("all of it runs at the client")));
}

TEST(DoctorVerdict, TellsWhatEachClassOfScenesDisplaysBehindTheMedianRoundTrip) {
  DoctorFindings found = sound_findings();
  found.network.round_trip.p50_ms = 20;
  const DoctorVerdict near = doctor_verdict(found);
  ASSERT_THAT(near.felt, SizeIs(4));
  EXPECT_EQ(near.felt[0].name, "static");
  EXPECT_DOUBLE_EQ(near.felt[0].at_client, 1);
  EXPECT_DOUBLE_EQ(near.felt[0].at_server, felt_classes()[0].at_server[1]);
  EXPECT_EQ(near.felt[1].name, "tissue");
  EXPECT_DOUBLE_EQ(near.felt[1].at_client, 1) << "no more than without a network";
  EXPECT_DOUBLE_EQ(near.felt[1].at_server, felt_classes()[1].at_server[1]);
  found.network.round_trip.p50_ms = 200;
  const DoctorVerdict far = doctor_verdict(found);
  EXPECT_DOUBLE_EQ(far.felt[2].at_client, 1);
  EXPECT_DOUBLE_EQ(far.felt[2].at_server, 0) << "it pushes in place of resisting";
}

TEST(DoctorVerdict, PutsWhatIsFarthestBeyondItsLimitFirst) {
  DoctorFindings found = sound_findings();
  found.network.up.lost = 500;          // 10 %, twice the limit
  found.network.longest_gap_ms = 2500;  // ten times
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(2));
  EXPECT_THAT(verdict.changes[0].why, AllOf(HasSubstr("2500 ms"), HasSubstr("250 ms")));
  EXPECT_THAT(verdict.changes[1].why, AllOf(HasSubstr("10 %"), HasSubstr("to the server"), HasSubstr("5 %")));
  EXPECT_DOUBLE_EQ(verdict.changes[1].urgency, 2);
  EXPECT_EQ(verdict.network, Grade::poor);
  EXPECT_EQ(verdict.machine, Grade::good);
}

TEST(DoctorVerdict, NamesTheDirectionThatLosesMore) {
  DoctorFindings found = sound_findings();
  found.network.down.lost = 400;
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(1));
  EXPECT_THAT(verdict.changes[0].change, HasSubstr("from the server"));
  EXPECT_EQ(verdict.network, Grade::fair);
}

TEST(DoctorVerdict, PutsAPathThatIsTooNarrowForAHelloBeforeAllElse) {
  DoctorFindings found = sound_findings();
  found.path.up_bytes = 500;
  found.network.up.lost = 4000;
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(2));
  EXPECT_THAT(verdict.changes[0].change, HasSubstr("1228"));
  EXPECT_THAT(verdict.changes[0].why, HasSubstr("528"));
  found.path.up_tried = false;
  EXPECT_THAT(doctor_verdict(found).changes, SizeIs(1)) << "what was not tried is no finding";
}

TEST(DoctorVerdict, MindsTheRoundTripMoreWhereForcesAreHeld) {
  DoctorFindings found = sound_findings();
  found.network.round_trip.p50_ms = 20;
  found.network.round_trip.p99_ms = 22;
  found.handshake.server_parts = wire::ServerParts::modelled;
  EXPECT_THAT(doctor_verdict(found).changes, IsEmpty());
  EXPECT_THAT(doctor_verdict(found).scene, HasSubstr("local models"));
  found.handshake.server_parts = wire::ServerParts::held;
  const DoctorVerdict held = doctor_verdict(found);
  ASSERT_THAT(held.changes, SizeIs(1));
  EXPECT_THAT(held.changes[0].change, HasSubstr("--explain"));
  EXPECT_DOUBLE_EQ(held.changes[0].urgency, 4);
  EXPECT_THAT(held.scene, HasSubstr("some of it runs at the client"));
  found.handshake.pieces_offered = 0;
  EXPECT_THAT(doctor_verdict(found).scene, HasSubstr("its forces are held"));
}

TEST(DoctorVerdict, SaysOnWhichWayTheJitterIs) {
  DoctorFindings found = sound_findings();
  found.network.round_trip.p99_ms = 90;
  found.network.down.above_least.p99_ms = 85;
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(1));
  EXPECT_THAT(verdict.changes[0].change, HasSubstr("the way from the server"));
  EXPECT_THAT(verdict.changes[0].why, HasSubstr("down"));
}

TEST(DoctorVerdict, AsksForPriorityWhereItIsNotGrantedEvenWithoutALateTick) {
  DoctorFindings found = sound_findings();
  found.machine.grant = {.memory_locked = true, .text = "no SCHED_FIFO"};
  found.machine.sleep_states.clear();
  const DoctorVerdict calm = doctor_verdict(found);
  ASSERT_THAT(calm.changes, SizeIs(1));
  EXPECT_THAT(calm.changes[0].change, AllOf(HasSubstr("rtprio 80"), HasSubstr("memlock")));
  EXPECT_LT(calm.changes[0].urgency, 1);
  EXPECT_EQ(calm.machine, Grade::good);
  found.machine.tick.late = 100;  // 2 %, twenty times the limit
  const DoctorVerdict late = doctor_verdict(found);
  EXPECT_DOUBLE_EQ(late.changes[0].urgency, 20);
  EXPECT_EQ(late.machine, Grade::poor);
}

TEST(DoctorVerdict, TellsAMachineThatIsLateFromLoadBesideTheTickByTheIdleThread) {
  DoctorFindings found = sound_findings();
  found.machine.tick.late = 10;  // 0.2 %
  const DoctorVerdict loaded = doctor_verdict(found);
  ASSERT_THAT(loaded.changes, SizeIs(1));
  EXPECT_THAT(loaded.changes[0].change, HasSubstr("other work"));
  EXPECT_EQ(loaded.machine, Grade::fair);
  found.machine.idle.late = 12;
  EXPECT_THAT(doctor_verdict(found).changes[0].change, HasSubstr("virtual"));
}

TEST(DoctorVerdict, MindsDeepSleepOnlyWhereProcessorsAreNotKeptAwake) {
  DoctorFindings found = sound_findings();
  found.machine.grant.processors_awake = false;
  found.machine.can_keep_awake = false;
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(1));
  EXPECT_THAT(verdict.changes[0].change, HasSubstr("/dev/cpu_dma_latency"));
  EXPECT_THAT(verdict.changes[0].why, HasSubstr("133 us"));
  found.machine.sleep_states[1].enabled = false;
  EXPECT_THAT(doctor_verdict(found).changes, IsEmpty());
}

TEST(DoctorVerdict, BlamesADriftOnlyIfItIsSure) {
  DoctorFindings found = sound_findings();
  found.network.drift = ClockDrift{.ppm = -900, .uncertain_ppm = 800};
  EXPECT_THAT(doctor_verdict(found).changes, IsEmpty());
  found.network.drift = ClockDrift{.ppm = -900, .uncertain_ppm = 100};
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(1));
  EXPECT_DOUBLE_EQ(verdict.changes[0].urgency, 4);
  EXPECT_THAT(verdict.changes[0].why, AllOf(HasSubstr("900 ppm"), HasSubstr("200")));
}

TEST(DoctorVerdict, SeesASceneThatTakesTheServerLongerThanATick) {
  DoctorFindings found = sound_findings();
  found.network.at_server.p99_ms = 3;
  const DoctorVerdict verdict = doctor_verdict(found);
  ASSERT_THAT(verdict.changes, SizeIs(1));
  EXPECT_EQ(verdict.changes[0].where, Advice::Where::server);
  EXPECT_EQ(verdict.network, Grade::fair);
}

}  // namespace
}  // namespace forcebound::client::commands
