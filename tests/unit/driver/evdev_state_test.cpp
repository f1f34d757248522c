#include "client/drivers/evdev_state.h"

#include <gtest/gtest.h>
#include <linux/input.h>

#include <array>
#include <cmath>

namespace forcebound::driver {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

evdev_state mouse(bool upright = false) {
  evdev_state state{};
  state.scale = {.count_m = 1e-4, .wheel_m = 5e-3, .width_m = 0.2, .follow_s = 0, .upright = upright ? 1 : 0};
  return state;
}

evdev_state absolute(evdev_range range) {
  evdev_state state = mouse();
  state.absolute = 1;
  state.z_code = ABS_RY;
  state.ranges[0] = state.ranges[1] = state.ranges[2] = range;
  return state;
}

std::array<double, 3> reported_m(const evdev_state& state) {
  return {state.reported_m[0], state.reported_m[1], state.reported_m[2]};
}

TEST(EvdevState, MovesThePointOfAMouseInTheScenesFrame) {
  evdev_state state = mouse();
  evdev_note(&state, EV_REL, REL_X, 100);
  evdev_note(&state, EV_REL, REL_Y, -50);
  evdev_note(&state, EV_REL, REL_WHEEL, 2);
  EXPECT_EQ(reported_m(state), (std::array{0.01, 0.005, 0.01})) << "right, away from the user, up";
}

TEST(EvdevState, MovesThePointOfAMouseUpIfTold) {
  evdev_state state = mouse(true);
  evdev_note(&state, EV_REL, REL_Y, -100);
  evdev_note(&state, EV_REL, REL_WHEEL, 1);
  EXPECT_EQ(reported_m(state), (std::array{0.0, 0.005, 0.01}));
}

TEST(EvdevState, KeepsThePointWithinItsBox) {
  evdev_state state = mouse();
  evdev_note(&state, EV_REL, REL_X, 1'000'000);
  EXPECT_EQ(state.reported_m[0], 0.1);
  evdev_note(&state, EV_REL, REL_X, -1'000);
  EXPECT_NEAR(state.reported_m[0], 0, 1e-15) << "at once, not when a million counts are back";
}

TEST(EvdevState, SpansTheBoxWithTheRangeOfAStick) {
  evdev_state state = absolute({.minimum = -32768, .maximum = 32767});
  evdev_note(&state, EV_ABS, ABS_X, 32767);
  evdev_note(&state, EV_ABS, ABS_Y, 32767);
  evdev_note(&state, EV_ABS, ABS_RY, -32768);
  EXPECT_EQ(reported_m(state), (std::array{0.1, -0.1, 0.1}))
      << "a stick's y is towards the user, as is its second one's";
  evdev_note(&state, EV_ABS, ABS_X, 0);
  EXPECT_NEAR(state.reported_m[0], 0, 0.2 / 65535);
}

TEST(EvdevState, TakesNoTriggerForAStick) {
  evdev_state state = absolute({.minimum = -32768, .maximum = 32767});
  evdev_note(&state, EV_ABS, ABS_Z, 255);
  EXPECT_EQ(reported_m(state), (std::array{0.0, 0.0, 0.0}));
}

TEST(EvdevState, TakesNoPositionFromARangeOfNothing) {
  evdev_state state = absolute({});
  evdev_note(&state, EV_ABS, ABS_X, 7);
  EXPECT_EQ(reported_m(state), (std::array{0.0, 0.0, 0.0}));
}

TEST(EvdevState, LeavesOutWhatIsOfTheOtherKindOfDevice) {
  evdev_state state = mouse();
  evdev_note(&state, EV_ABS, ABS_X, 100);
  evdev_note(&state, EV_REL, REL_HWHEEL, 100);
  evdev_note(&state, EV_SYN, SYN_REPORT, 0);
  EXPECT_EQ(reported_m(state), (std::array{0.0, 0.0, 0.0}));
}

TEST(EvdevState, NumbersTheButtonsOfEachKindFromZero) {
  for (const unsigned first : {BTN_LEFT, BTN_TRIGGER, BTN_SOUTH, BTN_0}) {
    evdev_state state = mouse();
    evdev_note(&state, EV_KEY, first, 1);
    evdev_note(&state, EV_KEY, first + 1, 1);
    EXPECT_EQ(state.buttons, 3U) << first;
    evdev_note(&state, EV_KEY, first, 2);
    EXPECT_EQ(state.buttons, 3U) << "repeated while it is held";
    evdev_note(&state, EV_KEY, first, 0);
    EXPECT_EQ(state.buttons, 2U) << first;
  }
  evdev_state state = mouse();
  evdev_note(&state, EV_KEY, BTN_TOUCH, 1);
  EXPECT_EQ(state.buttons, 1U);
  evdev_note(&state, EV_KEY, KEY_A, 1);
  EXPECT_EQ(state.buttons, 1U);
}

evdev_state cap() {
  evdev_state state = mouse();
  state.deflects = 1;
  return state;
}

TEST(EvdevState, SpansTheBoxWithTheDeflectionOfA3DMousesCap) {
  evdev_state state = cap();
  evdev_note(&state, EV_REL, REL_X, 350);
  evdev_note(&state, EV_REL, REL_Y, 175);
  evdev_note(&state, EV_REL, REL_Z, -400);
  EXPECT_EQ(reported_m(state), (std::array{0.1, -0.05, 0.1}));
  evdev_note(&state, EV_REL, REL_X, 35);
  EXPECT_NEAR(state.reported_m[0], 0.01, 1e-15) << "where it is, not by how much it moved";
  evdev_note(&state, EV_REL, REL_RX, 350);
  EXPECT_NEAR(state.reported_m[0], 0.01, 1e-15) << "turning moves nothing";
}

TEST(EvdevState, PutsASilentAxisOfACapInTheMiddle) {
  evdev_state state = cap();
  evdev_note(&state, EV_REL, REL_X, 350);
  evdev_follow(&state, kSecond_ns);
  evdev_note(&state, EV_REL, REL_Y, 350);
  evdev_follow(&state, kSecond_ns + kDeflected_ns);
  EXPECT_EQ(reported_m(state), (std::array{0.1, -0.1, 0.0}));
  evdev_follow(&state, kSecond_ns + kDeflected_ns + 1);
  EXPECT_EQ(reported_m(state), (std::array{0.0, -0.1, 0.0}));
  evdev_follow(&state, 2 * kSecond_ns);
  EXPECT_EQ(reported_m(state), (std::array{0.0, 0.0, 0.0}));
}

TEST(EvdevState, FollowsWithItsTimeConstant) {
  evdev_state state = mouse();
  state.scale.follow_s = 0.01;
  evdev_note(&state, EV_REL, REL_X, 100);
  evdev_follow(&state, kSecond_ns);
  EXPECT_EQ(state.point_m[0], 0) << "the first reading";
  evdev_follow(&state, kSecond_ns + kSecond_ns / 100);
  EXPECT_NEAR(state.point_m[0], 0.01 * (1 - std::exp(-1)), 1e-12);
  evdev_follow(&state, 2 * kSecond_ns);
  EXPECT_NEAR(state.point_m[0], 0.01, 1e-12);
}

}  // namespace
}  // namespace forcebound::driver
