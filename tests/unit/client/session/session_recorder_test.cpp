#include "forcebound/client/session/session_recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

/// The test gives what the other stages would.
class SessionRecorderTest : public ::testing::Test {
 protected:
  SessionRecorderTest() {
    rendered.policy = ForcePolicy::fresh;
    command.applied_N = Vector::Constant(1, -2.5);
  }

  /// @returns the row of a tick with the tool's tip there
  const record::TickRecord& record_at(double tip_m) {
    point.tip = Vector::Constant(1, tip_m);
    recorder.record({.now = now += 1ms,
                     .reading = reading,
                     .point = point,
                     .rendered = rendered,
                     .command = command,
                     .state = SessionState::active,
                     .newest = newest});
    return records.last;
  }

  /// At 0.25 m, 1 mm deep in a surface with normal -x.
  void touch() {
    newest.emplace();
    newest->position = Vector::Constant(1, 0.25);
    newest->answer.contact_normal = Vector::Constant(1, -1.0);
    newest->answer.penetration_m = 1e-3;
  }

  /// The scene at the client, this deep in a surface with normal -x.
  void touch_here(std::uint64_t scene, double penetration_m) {
    rendered.request.local =
        Answer{.force = Vector::Zero(1), .contact_normal = Vector::Constant(1, -1.0), .penetration_m = penetration_m};
    rendered.request.local_scene = scene;
  }

  Nanoseconds now{0};
  device::Reading reading;
  ToolPoint point;
  Renderer::Rendered rendered;
  Actuation::Command command;
  std::optional<wire::EnvironmentForce> newest;
  LastRecord records;
  std::array<record::TickSink*, 1> sinks{&records};
  SessionRecorder recorder{sinks};
};

TEST_F(SessionRecorderTest, NumbersTheTicksFromOne) {
  EXPECT_EQ(record_at(0).tick, 1U);
  EXPECT_EQ(record_at(0).tick, 2U);
  EXPECT_EQ(recorder.ticks(), 2U);
}

TEST_F(SessionRecorderTest, GivesTheDepthOnlyNearTheAnswersPosition) {
  touch();
  EXPECT_TRUE(record_at(0.25).contact);
  EXPECT_NEAR(records.last.penetration_m, 1e-3, 1e-12);
  EXPECT_EQ(records.last.displayed_N, 2.5);
  EXPECT_NEAR(record_at(0.2505).penetration_m, 1.5e-3, 1e-12) << "0.5 mm deeper";
  EXPECT_TRUE(std::isnan(record_at(0.2521).penetration_m)) << "2.1 mm away: the surface may have turned";
  EXPECT_TRUE(records.last.contact) << "as the newest answer says";
  EXPECT_TRUE(std::isnan(record_at(0.2485).penetration_m));
}

TEST_F(SessionRecorderTest, GivesNoContactBeforeTheFirstAnswerNorOfOneThatWasDropped) {
  EXPECT_FALSE(record_at(0.25).contact);
  EXPECT_TRUE(std::isnan(records.last.penetration_m));
  touch();
  rendered.policy = ForcePolicy::dropped;
  EXPECT_FALSE(record_at(0.25).contact);
  EXPECT_TRUE(std::isnan(records.last.penetration_m));
}

TEST_F(SessionRecorderTest, TheSceneAtTheClientSaysTheContactWhereItTouchesOrIsAllThereIs) {
  touch();
  touch_here(1, 2e-3);
  rendered.request.with_server_parts = true;
  EXPECT_EQ(record_at(0.25).penetration_m, 2e-3);
  EXPECT_EQ(records.last.displayed_N, 2.5);
  touch_here(1, 0);
  EXPECT_NEAR(record_at(0.25).penetration_m, 1e-3, 1e-12) << "in a part of the server's alone";
  rendered.request.with_server_parts = false;
  EXPECT_FALSE(record_at(0.25).contact);
  EXPECT_EQ(records.last.penetration_m, 0);
}

TEST_F(SessionRecorderTest, TheSceneAtTheClientIsAsOldAsItsFirstTick) {
  touch_here(1, 0);
  EXPECT_EQ(record_at(0).local_scene_age, 0ns);
  EXPECT_EQ(record_at(0).local_scene_age, 1ms);
  touch_here(2, 0);
  EXPECT_EQ(record_at(0).local_scene_age, 0ns);
  EXPECT_EQ(records.last.local_scene, 2U);
}

TEST_F(SessionRecorderTest, ARoundTripIsNeverNegative) {
  recorder.record({.motion_device_time = 5ms}, 7ms);
  EXPECT_EQ(records.last_force.round_trip, 2ms);
  recorder.record({.motion_device_time = 5ms}, 4ms);
  EXPECT_EQ(records.last_force.round_trip, 0ms);
}

TEST_F(SessionRecorderTest, ReplacesControlCharactersInWhatTheServerSaysOfItsScene) {
  EXPECT_EQ(recorder.begin_session({.scene = "wa\tll", .simulated = "\x1b]0;a wall\x07"}), "?]0;a wall?");
  record::RunTotals totals;
  recorder.add_to(totals);
  EXPECT_EQ(totals.scene, "wa?ll");
  EXPECT_EQ(totals.simulated, "?]0;a wall?");
}

TEST_F(SessionRecorderTest, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  touch();
  const std::string longest(wire::kTextBytesMax, 'x');
  const test::AllocationGuard guard;
  (void)recorder.begin_session({.scene = "wall", .simulated = longest});
  record_at(0.25);
  recorder.record(*newest, now);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
