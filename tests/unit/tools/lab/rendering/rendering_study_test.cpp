#include "tests/tools/lab/rendering/rendering_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/tools/lab/rendering/rendering_results.hpp"
#include "tests/tools/lab/rendering/rendering_tasks.hpp"

namespace forcebound::lab {
namespace {

TEST(RenderingStudy, RefusesAWordThatNoSceneHasAndNamesThoseThereAre) {
  try {
    (void)study_rendering({.only = "spere"}, [](double) {});
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("--only: no scene's name or class contains 'spere': "));
    EXPECT_THAT(error.what(), testing::HasSubstr("'edge of a box', 'corner of a box'"));
  }
}

/// Behind 100 ms, one seed.
RenderingRow row_behind_100_ms(const RenderingTask& task) {
  const std::vector<RenderingCondition> conditions = rendering_conditions();
  const auto behind = std::ranges::find(conditions, "100 ms", &RenderingCondition::name);
  return {.task = task.name,
          .group = task.group,
          .goal = task.goal,
          .condition = behind->name,
          .kind = behind->kind,
          .without_network = {play_rendering(task, {.name = "none", .kind = "none"}, {}, false, 1)},
          .remote = {play_rendering(task, *behind, {}, false, 1)},
          .local = {play_rendering(task, *behind, {}, true, 1)}};
}

class RenderingBehindATenthOfASecond : public testing::TestWithParam<const char*> {};

TEST_P(RenderingBehindATenthOfASecond, ReachesTheGoalOfItsScene) {
  const std::vector<RenderingTask> tasks = rendering_tasks();
  const auto task = std::ranges::find(tasks, GetParam(), &RenderingTask::name);
  if (task == tasks.end()) GTEST_SKIP() << "built without MuJoCo";
  const RenderingRow row = row_behind_100_ms(*task);
  EXPECT_THAT(rendering_markdown(rendering_json({.seeds = 1}, {row})), testing::HasSubstr("| reached |"));
  EXPECT_LT(displayed_over(row.remote[0], row.without_network[0]), 0.5);
  const bool stands_still = std::isfinite(row.goal.error);
  EXPECT_LT(row.local[0].ready_s, stands_still ? 1 : 3) << "the hand comes after 2 s";
  EXPECT_GT(row.local[0].at_client, 0.95);
  EXPECT_GT(row.local[0].start_B_per_s, row.local[0].steady_B_per_s / 2);
  EXPECT_GT(row.local[0].steady_B_per_s, 10e3) << "a motion on each tick";
}

INSTANTIATE_TEST_SUITE_P(Scenes, RenderingBehindATenthOfASecond,
                         testing::Values("plane, pressed at 3 Hz", "height field", "mesh of 5,856, 0.1 m/s",
                                         "pad, pressed at 3 Hz", "puck against a stop"),
                         [](const auto& scene) { return "Number" + std::to_string(scene.index); });

}  // namespace
}  // namespace forcebound::lab
