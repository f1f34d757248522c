#include "tests/tools/lab/accuracy/synchronised.hpp"

#include <gtest/gtest.h>

#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/unit/tools/lab/accuracy/body_scenes.hpp"

namespace forcebound::lab {
namespace {

TEST(TicksInCommon, HaveWholeStepsAndTwoOfEach) {
  EXPECT_EQ(ticks_in_common({0.001}), 2);
  EXPECT_EQ(ticks_in_common({0.0005, 0.00025}), 1);
  EXPECT_EQ(ticks_in_common({0.004, 0.002, 0.0001}), 8);
  EXPECT_EQ(ticks_in_common({0.002, 0.003}), 6);
  EXPECT_EQ(ticks_in_common({0.0007, 0.0013}), 20) << "there is none";
  EXPECT_EQ(ticks_in_common({}), 1);
}

TEST(RunSynchronised, TheReferenceIsItsOwnFreeRun) {
  const auto positions_m = pressing(201);
  const auto found = run_synchronised({stack("iterations = 1"), stack()}, 1, positions_m);
  ASSERT_TRUE(found);
  const Forces free = run_along(stack(), positions_m, time::SteadyClock()).forces;
  ASSERT_EQ(found->runs[1].forces.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(found->runs[1].forces[i], free[2 * (i + 1)]) << i;
  EXPECT_EQ(found->velocity_errors[1], 0);
  EXPECT_GT(found->velocity_errors[0], 0);
}

TEST(RunSynchronised, TheSameSettingHasNoErrorWhereverItBegan) {
  const auto found = run_synchronised({stack(), stack()}, 0, pressing(200));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->runs[0].forces, found->runs[1].forces);
  EXPECT_EQ(found->velocity_errors[1], 0);
}

TEST(RunSynchronised, ErrorsDoNotAddUpFromStateToState) {
  // Free, the stack collapses under so poor a solver; from the reference's states it is wrong by a share.
  const std::vector scenes{stack(), stack("solver = 'cg'\niterations = 1")};
  const auto positions_m = pressing(400);
  const auto found = run_synchronised(scenes, 0, positions_m);
  ASSERT_TRUE(found);
  const double size_N = rms(found->runs[0].forces);
  EXPECT_GT(rms_difference(found->runs[1].forces, found->runs[0].forces), 1e-6 * size_N);
  EXPECT_LT(rms_difference(found->runs[1].forces, found->runs[0].forces), 0.5 * size_N);
}

TEST(RunSynchronised, NeedsStatesThatCanBeCopied) {
  const auto tissue = server::load_scene("palpation");
  EXPECT_FALSE(run_synchronised({tissue, tissue}, 0, pressing(3)));
  EXPECT_FALSE(run_synchronised({stack(), server::load_scene("blocks")}, 0, pressing(3))) << "other bodies";
}

}  // namespace
}  // namespace forcebound::lab
