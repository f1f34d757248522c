#include <gtest/gtest.h>

#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"

namespace forcebound::server {
namespace {

TEST(ScenesWithATool, AreFeltByTheHandsThatTheirAuthorsSuggest) {
  for (const char* const name : {"peg_in_hole", "blade"}) {
    const auto made = load_scene(name);
    ASSERT_NE(made->facts().tool, nullptr) << name;
    EXPECT_EQ(made->least_rendering(), scene::Rendering::at_client) << name;
    const HandTrial trial = try_hand(made, suggested_hand(made));
    EXPECT_TRUE(trial.touched_s) << name;
    EXPECT_GE(trial.contacts, 1U) << name;
    EXPECT_FALSE(trial.starts_inside) << name;
  }
}

}  // namespace
}  // namespace forcebound::server
