// The shipped scenes that show local rendering: what differs behind a network must be the network's fault alone.

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>

#include "forcebound/device/load_device.hpp"
#include "forcebound/scene/rendering.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/stability.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"

namespace forcebound::server {
namespace {

struct ShownScene {
  const char* name;
  scene::Rendering how;
  bool has_bodies = false;
};

// So that a failure names the scene.
void PrintTo(const ShownScene& shown, std::ostream* out) { *out << shown.name; }

class SceneForLocalRendering : public testing::TestWithParam<ShownScene> {
 protected:
  void SetUp() override {
    if (GetParam().has_bodies && !has_bodies()) GTEST_SKIP() << "built without MuJoCo";
    scene_ = load_scene(GetParam().name);
  }

  std::shared_ptr<const scene::Scene> scene_;
};

TEST_P(SceneForLocalRendering, IsFeltByTheHandThatItsAuthorSuggests) {
  const SuggestedHand suggested = suggested_hand(scene_);
  EXPECT_FALSE(suggested.computed);
  const HandTrial trial = try_hand(scene_, suggested);
  EXPECT_FALSE(trial.starts_inside);
  EXPECT_TRUE(trial.touched_s);
}

TEST_P(SceneForLocalRendering, IsWithinWhatItsDeviceShowsWithoutALawAndANetwork) {
  const device::DeviceDescription device = device::load_device(suggested_hand(scene_).device);
  ASSERT_TRUE(device.facts.cartesian) << "the damping at the tip of an arm is not that of its joints";
  const double damping_N_s_per_m = device.facts.damping.diagonal().minCoeff();
  const Ringing all = ringing_of(*scene_);
  EXPECT_GT(all.stiffness_N_per_m, 0);
  EXPECT_LT(all.stiffness_N_per_m, 2 * damping_N_s_per_m / device.facts.period_s);
  constexpr double kDeep_m = 0.01;
  EXPECT_LT(all.damping_needed_N_s_per_m(device.facts.latency_s, kDeep_m), damping_N_s_per_m);
}

TEST_P(SceneForLocalRendering, IsOutOfReachOfThatDeviceBehindATenthOfASecond) {
  const device::DeviceDescription device = device::load_device(suggested_hand(scene_).device);
  constexpr double kRoundTrip_s = 0.1;
  EXPECT_GT(ringing_of(*scene_).damping_needed_N_s_per_m(kRoundTrip_s), device.facts.damping.diagonal().maxCoeff())
      << "remote rendering would show it as well";
}

TEST_P(SceneForLocalRendering, IsNotHeldInAnyPart) {
  ASSERT_GT(scene_->parts(), 0U);
  for (std::size_t part = 0; part < scene_->parts(); ++part) {
    EXPECT_EQ(scene_->rendering_of_part(part).how, GetParam().how) << scene_->rendering_of_part(part).why;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SceneForLocalRendering,
                         testing::Values(ShownScene{"dome", scene::Rendering::at_client},
                                         ShownScene{"pad", scene::Rendering::at_client},
                                         ShownScene{"block_and_stop", scene::Rendering::modelled, true},
                                         ShownScene{"two_on_a_block", scene::Rendering::modelled, true}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(SceneForTwo, SharesItsBlockAndLetsEachSideBePushed) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const auto scene = load_scene("two_on_a_block");
  EXPECT_TRUE(scene->facts().shared);
  EXPECT_EQ(scene->facts().clients_max, 2);
  // The second person's, as the scene's file says.
  const HandTrial second = try_hand(scene, {.device = "firm-3dof", .hand = "press:from_m=0.07,to_m=0.02,approach_s=1"});
  EXPECT_FALSE(second.starts_inside);
  EXPECT_TRUE(second.touched_s);
}

}  // namespace
}  // namespace forcebound::server
