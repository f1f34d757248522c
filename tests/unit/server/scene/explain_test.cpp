#include "forcebound/server/scene/explain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/server/scene/scene_library.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Explain, SaysWhatIsSimulatedWithUnits) {
  const std::string text = explain(*load_scene("plane"));
  EXPECT_THAT(text, HasSubstr("devices: 3 or 6 degrees of freedom\n"));
  EXPECT_THAT(text, HasSubstr("object 'table': half_space, through_m [0, 0, 0], normal [0, 0, 1]\n"));
  EXPECT_THAT(text, HasSubstr("effect 'surface': stiffness_N_per_m 2000, damping_N_s_per_m 1\n"));
  EXPECT_THAT(text, HasSubstr("velocity from successive motions\n"));
  EXPECT_THAT(text, HasSubstr("not simulated: torques; effects"));
}

TEST(Explain, SaysWhatIsNotSimulated) {
  const std::string wall = explain(*load_scene("wall"));
  EXPECT_THAT(wall, Not(HasSubstr("velocity from")));
  EXPECT_THAT(wall, HasSubstr("not simulated: torques; velocity (no effect needs it); effects"));
  const std::string free = explain(*load_scene("free"));
  EXPECT_THAT(free, HasSubstr("no objects: every force is zero\n"));
  EXPECT_THAT(free, HasSubstr("effects nobody asked for: surface, "));
}

TEST(Summary, IsOneLine) {
  EXPECT_EQ(summary(*load_scene("sphere")), "ball (sphere): surface stiffness_N_per_m 10000, damping_N_s_per_m 0");
  EXPECT_EQ(summary(*load_scene("free")), "nothing: every force is zero");
}

}  // namespace
}  // namespace forcebound::server
