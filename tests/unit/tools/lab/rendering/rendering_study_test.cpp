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
    (void)rendering_tasks_with("spere");
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("--only: no scene's name or class contains 'spere': "));
    EXPECT_THAT(error.what(), testing::HasSubstr("'edge of a box', 'corner of a box'"));
  }
}

/// Runs that differ in E_dev of local rendering alone.
RenderingRow row_with(const std::string& task, const std::string& group, const std::vector<double>& errors) {
  RenderingRow row{.task = task, .group = group, .condition = "100 ms", .kind = "delays"};
  for (const double error : errors) row.local.push_back({.error = error});
  row.remote = row.without_network = std::vector<RenderingFigures>(errors.size());
  return row;
}

TEST(RenderingStudy, FindsTheRunOfEachClassThatIsMostWrong) {
  const std::vector<RenderingRow> rows{row_with("a", "flat", {0.2, 0.1}), row_with("b", "flat", {0.1, 0.3}),
                                       row_with("c", "round", {0.1, 0.1})};
  const std::vector<WorstRendering> worst = worst_renderings(rows);
  ASSERT_EQ(worst.size(), 2U);
  EXPECT_EQ(worst[0].row, &rows[1]);
  EXPECT_EQ(worst[0].seed, 2U);
  EXPECT_EQ(worst[1].row, &rows[2]);
  EXPECT_EQ(worst[1].seed, 1U);
}

TEST(RenderingStudy, DrawsTheCourseWithoutANetworkRemoteAndLocal) {
  const std::vector<RenderingTask> tasks = rendering_tasks_with("plane, pressed at 3 Hz");
  const RenderingRow row = row_with(tasks.at(0).name, tasks.at(0).group, {0.25});
  const auto figure = rendering_course(tasks, {.row = &row, .seed = 1}, {.run = std::chrono::seconds{1}});
  EXPECT_EQ(figure.title(), "The worst of 'plane': plane, pressed at 3 Hz, 100 ms");
  const std::string csv = figure.to_csv();
  for (const char* const run : {"\n,fba-exact,", "\nremote rendering: E_dev 0.000,", "\nlocal rendering: E_dev 0.250,"})
    EXPECT_THAT(csv, testing::HasSubstr(run));
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
