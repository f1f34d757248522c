// A hand that presses a button of its handle, through a network.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

/// Mean and greatest force while the button was pressed, and after it was let go.
class Felt final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    const bool pressed = tick.handle.pressed(0);
    if (pressed) pressed_at = tick.time;
    const double force_N = tick.applied.norm();
    if (pressed) while_pressed_N = std::max(while_pressed_N, force_N);
    const bool long_after = pressed_at > 0ns && !pressed && tick.time > pressed_at + 2300ms;
    if (pressed_at > 0ns && !pressed) after_N = std::max(after_N, force_N);
    if (long_after) long_after_N = std::max(long_after_N, force_N);
    if (pressed_at == 0ns) before_N = std::max(before_N, force_N);
    if (tick.applied.rows() == 3) {
      if (tick.time > kLiftedFrom && tick.time < kLiftedUntil) {
        lifted_N += tick.applied[2];
        ++lifted;
      }
    }
  }

  // In which `carry` has lifted and carries.
  static constexpr Nanoseconds kLiftedFrom = 5s;
  static constexpr Nanoseconds kLiftedUntil = 7s;
  Nanoseconds pressed_at{0};
  double before_N = 0;
  double while_pressed_N = 0;
  double after_N = 0;
  double long_after_N = 0;
  double lifted_N = 0;
  int lifted = 0;
};

ClosedLoop::Settings through_50ms(const std::string& scene, const std::string& device, const std::string& hand,
                                  bool renders_locally) {
  const auto way = netem::parse_netem("delay 50ms 10ms loss 5%");
  return {.device = device::load_device(device),
          .hand = hand,
          .law = "fba-exact",
          .scene = server::load_scene(scene),
          .network = {.up = way, .down = way, .trace = {}, .seed = 7},
          .renders_locally = renders_locally};
}

class PressedButton : public testing::TestWithParam<bool> {};

//   omni, wave with a button from 2 to 5 s -- session ==( delay 50ms 10ms loss 5% )== server, grasp
TEST_P(PressedButton, HoldsTheHandWhileItIsPressedAndStaysPassive) {
  SCOPED_TRACE(std::string(GetParam() ? "local" : "remote") + " rendering, seed 7");
  Felt felt;
  ClosedLoop loop(through_50ms("grasp", "omni", "wave:amplitude_m=0.02,button_from_s=2,button_until_s=5", GetParam()),
                  {&felt});
  loop.run(8s);
  EXPECT_EQ(felt.before_N, 0);
  EXPECT_GT(felt.while_pressed_N, 0.5);
  EXPECT_EQ(felt.long_after_N, 0);
  if (GetParam()) {
    EXPECT_EQ(felt.after_N, 0) << "the scene at the client knows of the button on the very tick";
  }
  EXPECT_GE(loop.device().audit().value().minimum_J, 0);
}

// `carry` lifts the block of 0.1 kg from 2.5 to 4.5 s, and lets it go at 9.75 s.
//
//   firm-3dof, carry -- session ==( delay 50ms 10ms loss 5% )== server, pick_and_place
TEST_P(PressedButton, LiftsABlockWhoseWeightIsFeltUntilItIsPutDown) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  SCOPED_TRACE(std::string(GetParam() ? "local" : "remote") + " rendering, seed 7");
  const auto scene = server::load_scene("pick_and_place");
  const auto lift = [&](const std::string& button) {
    Felt felt;
    ClosedLoop loop(through_50ms("pick_and_place", scene->facts().suggested_device,
                                 scene->facts().suggested_hand + button, GetParam()),
                    {&felt});
    loop.run(13s);
    EXPECT_GE(loop.device().audit().value().minimum_J, 0);
    return felt;
  };
  const Felt grasped = lift("");
  EXPECT_NEAR(grasped.lifted_N / grasped.lifted, -0.1 * 9.81, 0.1);
  EXPECT_LT(grasped.long_after_N, 0.2) << "the hand is away";
  const Felt other = lift(",button=1");
  EXPECT_NEAR(other.lifted_N / other.lifted, 0, 0.05) << "another button than the scene's lifts nothing";
}

INSTANTIATE_TEST_SUITE_P(, PressedButton, testing::Bool(),
                         [](const auto& place) { return place.param ? "Local" : "Remote"; });

// The device's file asks for a button; the hand presses it from 2 to 5 s only.
TEST(DeadManButton, NoForceReachesTheHandUnlessItIsPressed) {
  const auto run = [](const std::string& button) {
    Felt felt;
    ClosedLoop::Settings settings = through_50ms("sphere", "omni", "trace-sphere" + button, true);
    settings.device.safety = {.ramp_s = 0.5, .dead_man_button = 0};
    ClosedLoop loop(std::move(settings), {&felt});
    loop.run(8s);
    EXPECT_GT(felt.while_pressed_N, felt.pressed_at > 0ns ? 0.5 : -1.0);
    EXPECT_EQ(felt.before_N, 0);
    EXPECT_EQ(felt.long_after_N, 0);
    return loop.totals().trips_of_dead_man;
  };
  EXPECT_EQ(run(":button=0,button_from_s=2,button_until_s=5"), 2U) << "at the start, and when it was let go";
  EXPECT_EQ(run(""), 1U) << "without buttons";
}

}  // namespace
}  // namespace forcebound::sim
