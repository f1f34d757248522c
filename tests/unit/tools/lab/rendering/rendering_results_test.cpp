#include "tests/tools/lab/rendering/rendering_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/support/source_folder.hpp"
#include "tests/tools/lab/rendering/rendering_tasks.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::lab {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kNotOnce = std::numeric_limits<double>::infinity();

RenderingFigures as_without_a_network() {
  return {.error = 0.02,
          .stiffness_N_per_m = 10e3,
          .true_share = 1,
          .felt_tick = 2100,
          .at_client = 1,
          .ready_s = 0.08,
          .start_B_per_s = 90e3,
          .steady_B_per_s = 70e3,
          .motions_per_s = 1000};
}

/// Three seeds behind 100 ms, all as without a network.
RenderingRow good_row() {
  const std::vector<RenderingFigures> good(3, as_without_a_network());
  return {.task = "plane",
          .group = "plane",
          .condition = "100 ms",
          .kind = "delays",
          .without_network = good,
          .remote = good,
          .local = good};
}

nlohmann::ordered_json study_of_rows(const std::vector<RenderingRow>& rows) { return rendering_json({}, rows); }

TEST(RenderingResults, ReachTheGoalsOfTheirClass) {
  EXPECT_THAT(
      rendering_markdown(study_of_rows({good_row()})),
      HasSubstr(
          "| plane | >= 0.99 | 1.000 | - | - | 0.000 | 0.000 | 0 | 0.00 | reached | 100.0 | 0.08 | 90.0 | 70.0 |"));
}

TEST(RenderingResults, MissThemByTheMedianOfTheStiffness) {
  RenderingRow row = good_row();
  row.local[0].stiffness_N_per_m = 5e3;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), HasSubstr("| reached |")) << "one seed of three";
  row.local[2].stiffness_N_per_m = 9.89e3;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), AllOf(HasSubstr("| **0.989** |"), HasSubstr("| **missed** |")));
  row.goal.stiffness = 0.95;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), HasSubstr("| reached |"));
}

TEST(RenderingResults, MissThemByTheErrorWhereThereIsAGoalForIt) {
  RenderingRow row = good_row();
  for (RenderingFigures& run : row.local) run.error = 0.031;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), AllOf(HasSubstr("| **0.011** |"), HasSubstr("| **missed** |")));
  row.goal.error = kNotOnce;
  const auto study = study_of_rows({row});
  EXPECT_THAT(rendering_markdown(study), HasSubstr("| reached |"));
  EXPECT_EQ(rendering_markdown(nlohmann::ordered_json::parse(rendering_file(study))), rendering_markdown(study))
      << "from a file";
}

TEST(RenderingResults, MissThemWhereLocalIsWorseThanRemote) {
  RenderingRow row = good_row();
  row.goal = kGoalOfWhatMoves;
  for (RenderingFigures& run : row.local) run.error = 0.5;
  for (RenderingFigures& run : row.remote) run.error = 0.481;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), AllOf(HasSubstr("| 0.019 |"), HasSubstr("| reached |")));
  for (RenderingFigures& run : row.remote) run.error = 0.479;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), AllOf(HasSubstr("| **0.021** |"), HasSubstr("| **missed** |")));
}

TEST(RenderingResults, MissThemByEnergyFromNowhereInOneSeed) {
  RenderingRow row = good_row();
  row.remote[1].minimum_J = -2e-9;
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), AllOf(HasSubstr("| **-2.00** |"), HasSubstr("| **missed** |")));
}

TEST(RenderingResults, NeverAverageAContactThatWasNotFelt) {
  RenderingRow row = good_row();
  row.local[1].felt_tick = row.local[1].ready_s = kNotOnce;
  const auto study = study_of_rows({row});
  const auto& local = study.at("rows").at(0).at("local");
  EXPECT_EQ(local.at("late_ticks").at(0), 0) << "the median";
  EXPECT_EQ(local.at("late_ticks").at(2), kNotOnce) << "the most";
  EXPECT_NEAR(local.at("ready_s").at(0).get<double>(), 0.08, 1e-12);
  EXPECT_THAT(rendering_markdown(study), AllOf(HasSubstr("| **never** |"), HasSubstr("| **missed** |")));
  row.local[2].felt_tick = row.local[0].felt_tick + 2;
  row.local[1] = row.local[0];
  const auto early = [&] {
    RenderingRow sooner = row;
    sooner.local[2].felt_tick = row.local[0].felt_tick - 2;
    return rendering_markdown(study_of_rows({sooner}));
  };
  EXPECT_THAT(early(), AllOf(HasSubstr("| **2** |"), HasSubstr("| **missed** |")));
  EXPECT_THAT(rendering_markdown(study_of_rows({row})), AllOf(HasSubstr("| **2** |"), HasSubstr("| **missed** |")));
}

TEST(RenderingResults, GoByTheShareOfTheTrueForceWhereNothingIsPressedIn) {
  RenderingFigures run = as_without_a_network();
  RenderingFigures without_network = run;
  run.stiffness_N_per_m = without_network.stiffness_N_per_m = std::nan("");
  run.true_share = 0.6;
  without_network.true_share = 0.8;
  EXPECT_NEAR(displayed_over(run, without_network), 0.75, 1e-12);
}

TEST(RenderingResults, FillNoLineOfATerminalWithMoreThanItHolds) {
  const std::string told = rendering_text(study_of_rows({good_row()}));
  for (const auto line : text::split(told, '\n')) EXPECT_LE(text::columns_of(line), text::kColumns) << line;
}

TEST(RenderingResults, ShowRemoteBesideLocal) {
  RenderingRow without_delay = good_row();
  without_delay.condition = "0 ms";
  RenderingRow delayed = good_row();
  for (RenderingFigures& run : delayed.remote) run.error = 0.4;
  delayed.local[2].minimum_J = -3e-9;
  RenderingRow dead = delayed;
  dead.condition = "blackout 3 s";
  dead.kind = "blackouts";
  for (RenderingFigures& run : dead.local) run.change_N_per_ms = 24;
  const std::string told = rendering_side_by_side(study_of_rows({without_delay, delayed, dead}));
  EXPECT_THAT(told, HasSubstr("E_dev, delays\n\n"
                              "  scene  remote   local    remote     local\n"
                              "         [0 ms]  [0 ms]  [100 ms]  [100 ms]\n"
                              "  plane   0.020   0.020     0.400     0.020\n"));
  EXPECT_THAT(told, HasSubstr("Largest change of the force applied [N/ms], blackouts\n\n"
                              "  scene          remote           local\n"
                              "         [blackout 3 s]  [blackout 3 s]\n"
                              "  plane            0.00           24.00\n"));
  EXPECT_THAT(told, HasSubstr("  plane    0.00    0.00      0.00     -3.00\n")) << "the worst seed's P";
  EXPECT_THAT(told, testing::Not(HasSubstr("recorded"))) << "none was run";
}

TEST(RenderingResults, KnowNothingOfAFigureThatAnOlderFileLacks) {
  auto study = study_of_rows({good_row()});
  for (const char* const rendering : {"without_network", "remote", "local"})
    study.at("rows").at(0).at(rendering).erase("true_share");
  EXPECT_THAT(rendering_csv(study), HasSubstr("\nplane,plane,100 ms,local,true_share,nan,nan,nan\n"));
}

TEST(RenderingResults, HaveARowOfDataForEachQuantityOfEachRendering) {
  const std::string csv = rendering_csv(study_of_rows({good_row()}));
  EXPECT_THAT(csv, testing::StartsWith("class,scene,condition,rendering,quantity,median,least,most\n"));
  EXPECT_THAT(csv, HasSubstr("\nplane,plane,100 ms,local,steady_B_per_s,70000,70000,70000\n"));
}

TEST(RenderingResults, AreDrawnByTheWorstSceneOfEachClass) {
  RenderingRow worse = good_row();
  worse.task = "plane, pressed";
  for (RenderingFigures& run : worse.local) run.stiffness_N_per_m = 9e3;
  const results::Figure figure = rendering_figure(study_of_rows({good_row(), worse}));
  EXPECT_EQ(figure.csv,
            "class,condition,remote_stiffness,local_stiffness,wanted_stiffness,remote_error,local_error,without_error\n"
            "plane,100 ms,1,0.9,0.99,0.02,0.02,0.02\n");
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed (gnuplot-nox)";
  const test::TemporaryFolder folder;
  testing::internal::CaptureStderr();
  EXPECT_EQ(draw(figure, folder.file("rendering.png")), folder.file("rendering.png"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(RenderingPage, QuotesTheCommittedStudyAndNoOther) {
  const std::string root = test::source_folder().string();
  const auto committed = nlohmann::ordered_json::parse(text::read_file(root + "/deploy/rendering-results.json"));
  EXPECT_EQ(text::between_marks(text::read_file(root + "/client/README.md"), kRenderingMarks),
            rendering_markdown(committed))
      << "the study in client/README.md is not that of deploy/rendering-results.json: run deploy/rendering";
}

TEST(RenderingTasks, HaveTheGoalsOfWhatTheyTouch) {
  for (const RenderingTask& task : rendering_tasks()) {
    const bool moves = task.group == "tissue" || task.group.starts_with("body");
    EXPECT_EQ(task.goal.stiffness, !moves ? 0.99 : task.group == "body against a stop" ? 0.9 : 0.95) << task.name;
    EXPECT_EQ(std::isfinite(task.goal.error), !moves) << task.name;
  }
}

}  // namespace
}  // namespace forcebound::lab
