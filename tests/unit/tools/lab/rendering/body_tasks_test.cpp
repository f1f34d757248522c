#include "tests/tools/lab/rendering/body_tasks.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "forcebound/server/environment/body_models.hpp"
#include "tests/tools/lab/rendering/rendering_study.hpp"

namespace forcebound::lab {
namespace {

TEST(BodyTasks, AreFeltAsTheyAreWithoutANetwork) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  for (const RenderingTask& task : body_tasks()) {
    SCOPED_TRACE(task.name);
    const RenderingFigures figures = play_rendering(task, {.name = "0 ms", .kind = "delays"}, {}, false, 1);
    EXPECT_GT(figures.felt_tick, 1900) << "the hand comes after 2 s";
    EXPECT_LT(figures.felt_tick, 3000);
    EXPECT_LT(figures.error, 0.15);
    EXPECT_NEAR(figures.true_share, 1, 0.05);
    EXPECT_GE(figures.minimum_J, -1e-9);
  }
}

TEST(BodyTasks, HaveHandsThatMoveWithoutAJump) {
  if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  constexpr double kStep_s = 1e-4;
  for (const RenderingTask& task : body_tasks()) {
    SCOPED_TRACE(task.name);
    const std::unique_ptr<const device::Operator> hand = task.make_hand();
    device::Operator::Target last = hand->target(0);
    for (double time_s = kStep_s; time_s < 6.5; time_s += kStep_s) {
      const device::Operator::Target now = hand->target(time_s);
      const control::Vector by_speed_m = kStep_s / 2 * (now.velocity + last.velocity);
      ASSERT_LT((now.position - last.position - by_speed_m).norm(), 1e-8) << "at " << time_s << " s";
      last = now;
    }
    EXPECT_TRUE(last.velocity.isZero(0));
  }
}

}  // namespace
}  // namespace forcebound::lab
