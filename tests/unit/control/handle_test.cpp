#include "forcebound/control/handle.hpp"

#include <gtest/gtest.h>

#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kNaN;

TEST(Handle, HasThoseButtonsPressedWhoseBitsAreSet) {
  const Handle handle{.buttons = 0x80000002};
  for (int button = -1; button <= 32; ++button) {
    EXPECT_EQ(handle.pressed(button), button == 1 || button == 31) << button;
  }
  EXPECT_FALSE(Handle{}.pressed(0)) << "it has no buttons";
}

TEST(Handle, ThatCanBeTrueStaysAsItIs) {
  const Handle told{.buttons = 0, .gripper = 1, .orientation = {{0.6, 0, -0.8, 0}}};
  EXPECT_EQ(sound(told).handle, told);
  EXPECT_EQ(sound(told).refused, 0);
  EXPECT_EQ(sound({}).handle, Handle{});
}

TEST(Handle, ThatIsOffByLittleIsMadeTrue) {
  const SoundHandle little = sound({.gripper = -0.01, .orientation = {{0, 0.995, 0, 0}}});
  EXPECT_EQ(little.handle, (Handle{.gripper = 0, .orientation = {{0, 1, 0, 0}}}));
  EXPECT_EQ(little.refused, 0);
}

TEST(Handle, FieldsThatCannotBeTrueAreAbsentAndCounted) {
  for (const double wrong : {-0.02, 1.02, kNaN, kInfinity, -kInfinity}) {
    const SoundHandle handle = sound({.buttons = 5, .gripper = wrong, .orientation = {{1, 0, 0, 0}}});
    EXPECT_EQ(handle.handle, (Handle{.buttons = 5, .orientation = {{1, 0, 0, 0}}})) << wrong;
    EXPECT_EQ(handle.refused, 1);
  }
  for (const Handle::Orientation& wrong :
       {Handle::Orientation{0, 0, 0, 0}, Handle::Orientation{1, 1, 0, 0}, Handle::Orientation{1, kNaN, 0, 0},
        Handle::Orientation{kInfinity, 0, 0, 0}, Handle::Orientation{1e300, 1e300, 0, 0}}) {
    const SoundHandle handle = sound({.gripper = 0.5, .orientation = wrong});
    EXPECT_EQ(handle.handle, Handle{.gripper = 0.5});
    EXPECT_EQ(handle.refused, 1);
  }
}

}  // namespace
}  // namespace forcebound::control
