#include "tests/tools/lab/accuracy/levels_text.hpp"

#include <gtest/gtest.h>

#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::lab {
namespace {

StudyResult three_levels() {
  StudyResult result{.key = "object.wall.surface.stiffness_N_per_m",
                     .hand = "press at 3 Hz",
                     .change_per_s = 18.8,
                     .reference_uncertainty = 0.002};
  for (const double error : {0.2, 0.03, 1e-9}) {
    StudiedSetting setting{.value = std::to_string(100 * (1 + result.settings.size())) + ".0"};
    setting.at_states.force = error;
    result.settings.push_back(setting);
  }
  return result;
}

TEST(LevelsText, IsWhatASceneNeedsToBeAuto) {
  const std::string scene =
      "[scene]\nname = 'w'\ndescription = ''\ndegrees_of_freedom = 1\naccuracy = 'auto'\n"
      "[[object]]\nname = 'wall'\nshape = { kind = 'half_space', through_m = [0], normal = [-1] }\n"
      "effects = ['surface']\nsurface = { stiffness_N_per_m = 1 }\n";
  const auto parsed = server::parse_scene(scene + levels_text(three_levels()), "w.toml");
  ASSERT_NE(parsed->accuracy(), nullptr);
  EXPECT_EQ(parsed->accuracy()->change_per_s, 18.8);
  ASSERT_EQ(parsed->accuracy()->levels.size(), 3U);
  EXPECT_EQ(parsed->accuracy()->levels[0].model_error, 0.2);
  EXPECT_EQ(parsed->accuracy()->levels[2].model_error, 0.002) << "as well as the reference is known";
}

TEST(LevelsText, HasTheExtrapolationOfAStudyThatWasRenderedLocally) {
  StudyResult result = three_levels();
  EXPECT_EQ(levels_text(result).find("extrapolation_per_s"), std::string::npos);
  result.extrapolation_per_s = 0.25;
  EXPECT_NE(levels_text(result).find("\nextrapolation_per_s = 0.25\n"), std::string::npos);
}

TEST(LevelsText, LeavesOutWhatFailed) {
  StudyResult result = three_levels();
  result.settings[1].trouble = "not converged";
  EXPECT_EQ(levels_text(result).find("200.0"), std::string::npos);
  result.settings[0].trouble = "not converged";
  EXPECT_THROW((void)levels_text(result), std::runtime_error);
}

}  // namespace
}  // namespace forcebound::lab
