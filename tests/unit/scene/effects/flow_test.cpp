#include "forcebound/scene/effects/flow.hpp"

#include <gtest/gtest.h>

#include "tests/support/effect_probe.hpp"
#include "tests/support/random_points.hpp"

namespace forcebound::scene {
namespace {

const Point kStream(0.3, 0, -0.4);

std::unique_ptr<Effect> flow(double damping_N_s_per_m, double drag_N_s2_per_m2) {
  return flow_effect().make({{"velocity_m_per_s", kStream},
                             {"damping_N_s_per_m", damping_N_s_per_m},
                             {"drag_N_s2_per_m2", drag_N_s2_per_m2}});
}

TEST(Flow, DragsADeviceAtRest) {
  EXPECT_LT((test::force_N(*flow(2, 0), {}) - Point(0.6, 0, -0.8)).norm(), 1e-15);
  EXPECT_LT((test::force_N(*flow(0, 4), {}) - Point(0.6, 0, -0.8)).norm(), 1e-15);
  EXPECT_LT((test::force_N(*flow(2, 4), {}) - Point(1.2, 0, -1.6)).norm(), 1e-15);
}

TEST(Flow, ExertsNoForceOnADeviceThatMovesWithIt) {
  EXPECT_EQ(test::force_N(*flow(2, 4), {.velocity_m_per_s = kStream}), Point(0, 0, 0));
}

TEST(Flow, SlowsDownADeviceFasterThanTheFlow) {
  EXPECT_LT((test::force_N(*flow(2, 4), {.velocity_m_per_s = 2 * kStream}) - Point(-1.2, 0, 1.6)).norm(), 1e-15);
}

TEST(Flow, DissipatesInTheFrameOfTheFluid) {
  const auto effect = flow(2, 4);
  ASSERT_TRUE(rc::check([&] {
    const Point velocity = test::draw_point(10);
    RC_ASSERT(test::force_N(*effect, {.velocity_m_per_s = velocity}).dot(velocity - kStream) <= 0);
  }));
}

TEST(Flow, LooksAtVelocity) { EXPECT_TRUE(flow(1, 0)->facts().inputs.velocity); }

}  // namespace
}  // namespace forcebound::scene
