#include "forcebound/client/page/known_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "forcebound/client/page/scene_files.hpp"
#include "forcebound/device/load_device.hpp"

namespace forcebound::client {
namespace {

TEST(KnownScenes, AreAllThatShip) {
  EXPECT_EQ(known_scenes().size(), scene_files().size());
  EXPECT_EQ(find_known_scene("nowhere"), nullptr);
}

TEST(KnownScenes, HaveADeviceThatSuitsThemAndAPlaceToBegin) {
  for (const KnownScene& scene : known_scenes()) {
    SCOPED_TRACE(scene.name);
    const int rows = device::load_device(device_for(scene)).facts.degrees_of_freedom();
    EXPECT_TRUE(scene.accepts(rows));
    EXPECT_EQ(start_in(&scene, rows).rows(), rows);
    EXPECT_TRUE(start_in(&scene, rows).allFinite());
  }
}

TEST(KnownScenes, SayWhichDevicesTheyAreFor) {
  const KnownScene* const sphere = find_known_scene("sphere");
  ASSERT_NE(sphere, nullptr);
  EXPECT_EQ(device_for(*sphere), "omni");
  EXPECT_FALSE(sphere->shared);
  EXPECT_TRUE(find_known_scene("two_on_a_block")->shared);
  EXPECT_TRUE(sphere->accepts(3));
  EXPECT_TRUE(sphere->accepts(6));
  EXPECT_FALSE(sphere->accepts(1));
  EXPECT_NEAR(start_in(sphere, 3).norm(), 0.04, 1e-12);  // where its hand begins
  EXPECT_TRUE(find_known_scene("wall")->accepts(1));
  EXPECT_LT(start_in(find_known_scene("wall"), 1)[0], 0);
  EXPECT_EQ(start_in(nullptr, 2).rows(), 2);
}

}  // namespace
}  // namespace forcebound::client
