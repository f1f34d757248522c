#include "tests/tools/lab/comparison/standing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "forcebound/text/file.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

TrialRun trial(Conditions conditions, double least_P_J, double shown_N_per_m) {
  TrialRun trial_run{.setup = {.task = task_of("wall"),
                               .stiffness_N_per_m = 10e3,
                               .network = network_of("none"),
                               .conditions = conditions},
                     .trial = {}};
  trial_run.trial.passivity_minimum_J = least_P_J;
  trial_run.trial.shown_N_per_m = shown_N_per_m;
  trial_run.trial.error = 0.25;
  trial_run.trial.calm = shown_N_per_m > 5e3;
  return trial_run;
}

ComparisonResult two_laws() {
  ComparisonResult result{.settings = {.laws = {"none", "fba-more"},
                                       .tasks = {task_of("wall")},
                                       .networks = {network_of("none")},
                                       .stiffnesses_N_per_m = {10e3},
                                       .delays_s = {0}}};
  result.theory.push_back(theory_limits("wall-1dof", 0));
  LawInComparison none{.law = "none", .work_ns = 50};
  none.trials = {trial(Conditions::ideal, 0, 10e3), trial(Conditions::real, -0.5, 9e3), trial(Conditions::real, 0, 4e3),
                 trial(Conditions::real, 0, 8e3)};
  none.stable = {{{.N_per_m = 62e3}, {.N_per_m = 70e3}, {.N_per_m = 1e6, .no_limit = true}}};
  LawInComparison refusing{.law = "fba-more"};
  refusing.trials = {trial(Conditions::real, 0, 0)};
  refusing.trials[0].trial.refused = "law 'fba-more': no";
  refusing.stable = {{{}, {}, {}}};
  result.laws = {none, refusing};
  return result;
}

TEST(Standings, AreWorstPAndMediansOfTheRest) {
  const auto law = standings(two_laws()).at("laws").at(0);
  EXPECT_EQ(law.at("ideal").at("least_P_J"), 0);
  EXPECT_EQ(law.at("real").at("least_P_J"), -0.5);
  EXPECT_EQ(law.at("real").at("passive"), 2);
  EXPECT_EQ(law.at("trials"), 3);
  EXPECT_DOUBLE_EQ(law.at("calm"), 2.0 / 3);
  EXPECT_DOUBLE_EQ(law.at("behind").at(0).at("shown"), 0.8);
  EXPECT_DOUBLE_EQ(law.at("behind").at(0).at("error"), 0.25);
}

TEST(Standings, NameTheLawsThatRefuseTheDevice) {
  EXPECT_THAT(to_text(standings(two_laws())), testing::ContainsRegex("fba-more +refuses: law 'fba-more': no\n"));
  EXPECT_THAT(to_csv(two_laws()), HasSubstr(",\"law 'fba-more': no\"\n"));
}

TEST(Standings, TellTheStiffestWallUnderEachHand) {
  EXPECT_THAT(to_text(standings(two_laws())), HasSubstr("62/70/all\n"));
  EXPECT_THAT(comparison_markdown(standings(two_laws())), HasSubstr("| `none` | 62/70/all |\n"));
}

TEST(Standings, AreARowOfTheReadmeForEachLawThatPlayed) {
  EXPECT_THAT(comparison_markdown(standings(two_laws())),
              HasSubstr("| law | least P ideal [mJ] | least P real [mJ] | at rest [%] | shown, none [%] | E_dev, none "
                        "[%] | time [ns] |\n"
                        "|---|---|---|---|---|---|---|\n"
                        "| `none` | 0 | -500 | 66.7 | 80 | 25 | 50 |\n"));
}

TEST(Comparison, PlaysEveryLawOnEverythingWithTheSameEffort) {
  const ComparisonSettings settings{.laws = {"none", "eba"},
                                    .tasks = {task_of("wall")},
                                    .networks = {network_of("none"), network_of("delay 10ms")},
                                    .stiffnesses_N_per_m = {10e3, 50e3},
                                    .effort = 2};
  std::size_t last = 0;
  const ComparisonResult result =
      run_comparison(settings, time::SteadyClock(), [&](std::size_t done, std::size_t) { last = done; });
  ASSERT_EQ(result.laws.size(), 2U);
  EXPECT_EQ(last, 2 * (2U + 8U));
  EXPECT_EQ(result.laws[0].tuned[0].tuning.tried, 0) << "has no parameters";
  EXPECT_EQ(result.laws[1].tuned[0].tuning.tried, 2);
  for (const LawInComparison& law : result.laws) {
    EXPECT_EQ(law.trials.size(), 8U);
    for (const TrialRun& trial_run : law.trials) EXPECT_GT(trial_run.trial.force_N_mean, 0) << law.law;
    EXPECT_GT(law.work_ns, 0);
  }
}

TEST(Comparison, PassesOnWhatALawRefuses) {
  const ComparisonSettings settings{.laws = {"no such law"},
                                    .tasks = {task_of("wall")},
                                    .networks = {network_of("none")},
                                    .stiffnesses_N_per_m = {10e3},
                                    .effort = 1};
  EXPECT_THROW((void)run_comparison(settings, time::SteadyClock(), [](std::size_t, std::size_t) {}),
               std::invalid_argument);
}

TEST(Page, QuotesTheCommittedComparisonAndNoOther) {
  const std::string root = test::source_folder().string();
  const auto committed = nlohmann::ordered_json::parse(text::read_file(root + "/deploy/comparison-results.json"));
  EXPECT_EQ(text::between_marks(text::read_file(root + "/common/forcebound/baselines/README.md"), kComparisonMarks),
            comparison_markdown(committed))
      << "the comparison in common/forcebound/baselines/README.md is not that of deploy/comparison-results.json: run "
         "deploy/comparison --keep";
}

}  // namespace
}  // namespace forcebound::lab
