#include "forcebound/client/session/renderer.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

/// The test gives the newest answer.
class RendererTest : public ::testing::Test {
 protected:
  explicit RendererTest(int rows = 1) { reading.position = Vector::Zero(rows); }

  Renderer::Rendered render_after(Nanoseconds pause) {
    now += pause;
    reading.latched = now;
    const ToolPoint point = renderer.point_of(reading, reading.position);
    return renderer.render({.now = now,
                            .reading = reading,
                            .elapsed_s = time::to_seconds(pause),
                            .point = point,
                            .newest = newest,
                            .newest_arrival = now,
                            .clocks = clocks});
  }

  /// To the reading of now.
  void answer(const Vector& force_N) {
    wire::EnvironmentForce force;
    force.session = kSession;
    force.motion_sequence = ++motions;
    force.motion_device_time = now;
    force.answer.force = force_N;
    force.position = reading.position;
    newest = force;
  }

  Nanoseconds now{1s};
  device::Reading reading;
  ClockOffset clocks;
  std::optional<wire::EnvironmentForce> newest;
  std::uint64_t motions = 0;
  Events events;
  EventReporter reporter{&events};
  Renderer renderer{{}, reporter};
};

TEST_F(RendererTest, RefusesToHoldLongerThanUntilItDrops) {
  EXPECT_THROW(Renderer({.policy = {.hold = 2s, .drop = 1s}}, reporter), std::invalid_argument);
}

TEST_F(RendererTest, AsksForNothingBeforeTheFirstAnswer) {
  const Renderer::Rendered rendered = render_after(1ms);
  EXPECT_TRUE(rendered.silent);
  EXPECT_EQ(rendered.policy, ForcePolicy::none);
  EXPECT_EQ(rendered.force_sequence, 0U);
  EXPECT_EQ(rendered.request.force_N, Vector::Zero(1));
  EXPECT_TRUE(events.kinds.empty());
}

TEST_F(RendererTest, HoldsFadesAndDropsTheNewestAnswer) {
  answer(Vector::Constant(1, -2.0));
  Renderer::Rendered rendered = render_after(250ms);
  EXPECT_EQ(rendered.force_sequence, 1U);
  EXPECT_EQ(rendered.force_age, 250ms);
  EXPECT_EQ(rendered.policy, ForcePolicy::fresh);
  EXPECT_EQ(rendered.request.force_N[0], -2);
  rendered = render_after(375ms);
  EXPECT_EQ(rendered.policy, ForcePolicy::fading);
  EXPECT_NEAR(rendered.request.force_N[0], -1, 1e-12);
  EXPECT_FALSE(rendered.silent);
  rendered = render_after(375ms);
  EXPECT_EQ(rendered.policy, ForcePolicy::dropped);
  EXPECT_TRUE(rendered.silent);
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::force_fading, Event::Kind::force_dropped}));
}

TEST_F(RendererTest, CountsTheTimeWithoutFreshForcesFromTheHoldTimeThoughItSlept) {
  answer(Vector::Constant(1, -2.0));
  (void)render_after(1ms);
  (void)render_after(2s);
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::force_dropped}));
  EXPECT_EQ(events.duration, 2s + 1ms) << "its age";
  answer(Vector::Constant(1, -2.0));
  (void)render_after(1ms);
  EXPECT_EQ(events.kinds.back(), Event::Kind::force_fresh);
  EXPECT_EQ(events.duration, 2s + 2ms - 250ms);
}

TEST_F(RendererTest, NeedsAMotionOnEachTickWhereNothingRunsHere) {
  answer(Vector::Constant(1, -2.0));
  EXPECT_EQ(motion_interval(render_after(1ms).need), 0ns);
  EXPECT_FALSE(renderer.begin_motion(now).wanted) << "no pieces either";
}

class RendererOfThreeAxes : public RendererTest {
 protected:
  RendererOfThreeAxes() : RendererTest(3) {
    renderer.begin_session({.session = kSession, .tool_m = Eigen::Vector3d(0, 0, -0.1)});
    reading.handle.orientation = control::Handle::Orientation{1, 0, 0, 0};
  }
};

TEST_F(RendererOfThreeAxes, AsksForTheTorqueOfAForceAtTheToolsTip) {
  answer(Eigen::Vector3d(2, 0, 0));
  const Renderer::Rendered rendered = render_after(1ms);
  EXPECT_EQ(rendered.request.force_N, Eigen::Vector3d(2, 0, 0));
  EXPECT_LT((rendered.request.torque_N_m - Eigen::Vector3d(0, -0.2, 0)).norm(), 1e-12);
  const ToolPoint point = renderer.point_of(reading, Eigen::Vector3d(0.01, 0, 0));
  EXPECT_EQ(point.tip, Eigen::Vector3d(0, 0, -0.1));
  EXPECT_EQ(point.place, Eigen::Vector3d(0.01, 0, -0.1)) << "where the law wants it asked";
}

TEST_F(RendererOfThreeAxes, WithoutAnOrientationHasNoToolAndSaysSoOnceInASession) {
  (void)render_after(1ms);
  EXPECT_TRUE(events.kinds.empty());
  reading.handle.orientation.reset();
  EXPECT_EQ(renderer.point_of(reading, reading.position).tip, Eigen::Vector3d(0, 0, 0));
  for (int i = 0; i < 3; ++i) (void)render_after(1ms);
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::tool_lost}));
  renderer.begin_session({.session = kSession + 1, .tool_m = Eigen::Vector3d(0, 0, 0)});
  (void)render_after(1ms);
  EXPECT_EQ(events.kinds, (std::vector{Event::Kind::tool_lost, Event::Kind::tool_lost}));
  renderer.begin_session({.session = kSession + 2});
  (void)render_after(1ms);
  EXPECT_EQ(events.kinds.size(), 2U) << "without a tool there is nothing to say";
}

TEST_F(RendererOfThreeAxes, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  answer(Eigen::Vector3d(2, 0, 0));
  events.kinds.reserve(10);
  const test::AllocationGuard guard;
  for (const Nanoseconds pause : {1ms, 400ms, 700ms}) (void)render_after(pause);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
