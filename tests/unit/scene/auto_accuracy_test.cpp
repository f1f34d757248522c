#include "forcebound/scene/auto_accuracy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace forcebound::scene {
namespace {

using testing::HasSubstr;

const AutoAccuracy kThree{.key = "tissue.pad.shape.cells",
                          .change_per_s = 20,
                          .levels = {{.value = "[2, 2, 1]", .model_error = 0.2, .step_s = 20e-6},
                                     {.value = "[4, 4, 2]", .model_error = 0.05, .step_s = 200e-6},
                                     {.value = "[8, 8, 4]", .model_error = 0.01, .step_s = 5e-3}}};

TEST(AutoAccuracy, CountsRoundTripComputationAndTheWaitForTheNextForceAsAge) {
  // 5 ms of round trip, 0.02 ms to compute, half a tick to be looked at, half a tick till the next.
  EXPECT_DOUBLE_EQ(kThree.expected_error(kThree.levels[0], {.round_trip_s = 5e-3}),
                   std::hypot(0.2, 20 * (5e-3 + 20e-6 + 1e-3)));
  // A computation longer than a tick is also what one waits for the next.
  EXPECT_DOUBLE_EQ(kThree.expected_error(kThree.levels[2], {.round_trip_s = 5e-3}),
                   std::hypot(0.01, 20 * (5e-3 + 5e-3 + 3e-3)));
}

TEST(AutoAccuracy, PicksTheFinestForWhatCostsNothing) {
  AutoAccuracy free = kThree;
  for (AccuracyLevel& level : free.levels) level.step_s = 0;
  for (const double round_trip_s : {0.0, 0.01, 0.1})
    EXPECT_EQ(free.best({.round_trip_s = round_trip_s}).value, "[8, 8, 4]");
}

TEST(AutoAccuracy, PicksACoarserLevelTheFartherAwayTheClientIs) {
  AutoAccuracy scene = kThree;
  scene.levels[2].step_s = 1.2e-3;
  scene.levels[1].model_error = 0.06;
  EXPECT_EQ(scene.best({}).value, "[8, 8, 4]");
  EXPECT_EQ(scene.best({.round_trip_s = 20e-3}).value, "[4, 4, 2]");
  scene.levels[1].step_s = 1.2e-3;
  scene.levels[0].model_error = 0.1;
  EXPECT_EQ(scene.best({.round_trip_s = 1}).value, "[2, 2, 1]");
}

TEST(AutoAccuracy, PicksAFinerLevelWhereOnlyItsModelTravels) {
  AutoAccuracy scene = kThree;
  scene.levels[1].step_s = 1.2e-3;
  scene.levels[0].model_error = 0.1;
  scene.change_locally_per_s = 2;
  EXPECT_EQ(scene.best({.round_trip_s = 0.1}).value, "[2, 2, 1]");
  EXPECT_EQ(scene.best({.round_trip_s = 0.1, .renders_locally = true}).value, "[4, 4, 2]");
  scene.change_locally_per_s = 0;
  EXPECT_EQ(scene.best({.round_trip_s = 0.1, .renders_locally = true}).value, "[8, 8, 4]");
  EXPECT_THAT(scene.text(scene.levels[2], {.round_trip_s = 0.1, .renders_locally = true}),
              HasSubstr("for a round trip of 100 ms and local rendering, 5000 us a motion, the force about 1 % off"));
}

TEST(AutoAccuracy, SaysWhatIsPickedAndWhatToExpect) {
  const std::string said = kThree.text(kThree.levels[1], {.round_trip_s = 5e-3});
  EXPECT_EQ(said,
            "accuracy auto: tissue.pad.shape.cells = [4, 4, 2] for a round trip of 5 ms, 200 us a motion, the force "
            "about 13.4 % off at the device");
}

}  // namespace
}  // namespace forcebound::scene
