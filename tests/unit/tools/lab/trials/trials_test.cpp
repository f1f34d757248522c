#include "tests/tools/lab/trials/trials.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"

namespace forcebound::lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TrialsSettings settings_for(const std::string& scene) {
  const server::SuggestedHand suggested = server::suggested_hand(server::load_scene(scene));
  return {.scene = scene,
          .device = suggested.device,
          .hand = suggested.hand,
          .network = "delay 50ms 5ms loss 5%",
          .laws = {"fba-exact"},
          .duration_s = 4};
}

std::vector<PlayedTrial> played(const TrialsSettings& settings) {
  return play_trials(settings, nullptr, [](double) {});
}

std::vector<std::string> renderings_of(const std::vector<PlayedTrial>& trials) {
  std::vector<std::string> names;
  names.reserve(trials.size());
  for (const PlayedTrial& trial : trials) names.push_back(trial.law + " " + trial.rendering);
  return names;
}

double displayed_N_per_m(const PlayedTrial& trial) {
  return results::number_at(trial.summary, "/displayed_stiffness_N_per_m/median");
}

TEST(PlayTrials, PlaysEachLawWithoutANetworkAndThenWithEachRendering) {
  TrialsSettings settings = settings_for("plane");
  settings.laws = {"fba-exact", "none"};
  settings.duration_s = 0.1;
  EXPECT_THAT(renderings_of(played(settings)),
              ElementsAre("fba-exact no network", "fba-exact local", "fba-exact remote", "none no network",
                          "none local", "none remote"));
  settings.renderings = {"remote"};
  settings.network = "none";
  EXPECT_THAT(renderings_of(played(settings)), ElementsAre("fba-exact remote", "none remote"));
}

TEST(TrialsTable, SaysWhichLawsRefuseLocalRendering) {
  TrialsSettings settings = settings_for("plane");
  settings.laws = {"tdpa-er"};
  settings.duration_s = 0.1;
  const std::vector<PlayedTrial> trials = played(settings);
  EXPECT_THAT(trials_table(settings, trials, text::Colour::none),
              HasSubstr("tdpa-er  refuses: local rendering, as all forces go through its server-side\n    law\n"));
  EXPECT_EQ(trials.back().refused, "") << trials.back().rendering;
}

TEST(TrialsTable, SaysWhyThereAreDashesWhereTheHandNeverTouched) {
  TrialsSettings settings = settings_for("sphere");
  settings.hand = "press:from_m=0.2,to_m=0.19";
  settings.duration_s = 0.2;
  const std::string table = trials_table(settings, played(settings), text::Colour::none);
  EXPECT_THAT(table, HasSubstr(" -       "));
  EXPECT_THAT(table, HasSubstr("\n  -           the hand never touched the scene: "));
}

TEST(PlayTrials, TheDomeIsAsStiffAsWithoutANetworkWithLocalRenderingOnly) {
  const TrialsSettings settings = settings_for("dome");
  const std::vector<PlayedTrial> trials = played(settings);
  ASSERT_EQ(trials.size(), 3U);
  const double without = displayed_N_per_m(trials[0]);
  EXPECT_GT(without, 8000) << "of 10000";
  EXPECT_NEAR(displayed_N_per_m(trials[1]), without, 0.02 * without);
  EXPECT_EQ(trials[0].off_by, 0);
  EXPECT_LT(trials[1].off_by.value(), 0.05);
  EXPECT_GT(trials[2].off_by.value(), 0.5) << "thrown off, and rarely at rest";
  for (const PlayedTrial& trial : trials) {
    EXPECT_GE(results::number_at(trial.summary, "/passivity/minimum_J"), -1e-9) << trial.rendering;
  }
  EXPECT_THAT(trials_table(settings, trials, text::Colour::none), HasSubstr("fba-exact  no network"));
}

TEST(TrialsTable, HasTheRotationalStiffnessWhereADeviceShowsTorque) {
  TrialsSettings settings = settings_for("blade");
  settings.network = "none";
  settings.renderings = {"local"};
  settings.duration_s = 6;
  const std::vector<PlayedTrial> trials = played(settings);
  ASSERT_TRUE(trials.front().rotational_N_m_per_rad);
  // 500 N/m on the corners of a sole of 60 x 20 mm, turned about its longer side: 500 N/m (10 mm)^2, less where it
  // lifts.
  EXPECT_GT(*trials.front().rotational_N_m_per_rad, 0.005);
  EXPECT_LT(*trials.front().rotational_N_m_per_rad, 1);
  EXPECT_THAT(trials_table(settings, trials, text::Colour::none), HasSubstr("[N m/rad]"));
  settings = settings_for("plane");
  settings.duration_s = 0.1;
  EXPECT_THAT(trials_table(settings, played(settings), text::Colour::none), Not(HasSubstr("N m/rad")));
}

}  // namespace
}  // namespace forcebound::lab
