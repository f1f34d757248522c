#include "forcebound/client/rendering/answer_rendering.hpp"

#include <gtest/gtest.h>

#include "tests/unit/client/rendering/rendered_answer.hpp"

namespace forcebound::client {
namespace {

TEST_F(RenderedAnswer, LetsWhatMovesFadeWithTheHeldForceWhenTheServerIsSilent) {
  receive_pad(0.002);
  // Slower than what would be felt.
  newest.answer.model.surfaces[0].velocity_m_per_s.x() = 1e-9;
  expect_to_fade(-0.003, 3);
}

TEST_F(RenderedAnswer, KeepsASurfaceThatStandsStillWhenTheServerIsSilent) {
  receive_pad(0.002, 1);
  EXPECT_NEAR(settled_at(-0.003), 4, 1e-6);
  EXPECT_TRUE(rendered.fades) << "what else there is";
  answers = {};  // so that nothing was foretold
  receive_pad(0.002);
  EXPECT_NEAR(settled_at(-0.003), 3, 1e-6);
  EXPECT_FALSE(rendered.fades);
  for (const double left : {0.5, 0.0}) {
    share = left;
    EXPECT_NEAR(at(-0.003), 3, 1e-6);
    EXPECT_NEAR(at(-0.001), 1, 1e-6);
    EXPECT_NEAR(rendered.model_N[2], 1, 1e-6);
    EXPECT_NEAR(at(-0.003, 1), left * 2, 1e-6) << "beyond its radius there is what was held";
  }
}

TEST_F(RenderedAnswer, KeepsADraggedMassButNotWhatElsePullsAtItWhenTheServerIsSilent) {
  receive(0);
  newest.answer.model.mass = {.id = 1,
                              .stiffness_N_per_m = 500,
                              .damping_N_s_per_m = 20,
                              .body = {.bias_m_per_s2 = {0, 0, 1}, .mobility_per_kg = Eigen::Matrix3d::Identity()},
                              .radius_m = 1};
  newest.answer.model.has_mass = true;
  (void)at(0);
  for (int i = 0; i < 10; ++i) (void)settled_at(0);
  EXPECT_NEAR(at(0), 1, 0.01) << "it hangs from the device";
  share = 0;
  for (int i = 0; i < 10; ++i) (void)settled_at(0);
  EXPECT_NEAR(at(0), 0, 0.01);
  EXPECT_NEAR(settled_at(0.01), 0, 5.1) << "it follows the device";
  EXPECT_LT(at(0.02), -1) << "it is still there";
}

TEST_F(RenderedAnswer, TellsThatWhatMovesWouldFadeAlsoWhereTheAnswerHadNoForceOfIt) {
  server_parts_alone = true;
  receive_pad(0);
  newest.answer.server_parts_N.resize(0);
  EXPECT_NEAR(at(-0.002), 2, 1e-9);
  EXPECT_FALSE(rendered.fades) << "it stands still";
  receive_pad(0);
  newest.answer.server_parts_N.resize(0);
  newest.answer.model.surfaces[0].velocity_m_per_s.x() = 1e-9;
  EXPECT_NEAR(at(-0.002), 2, 1e-9);
  EXPECT_TRUE(rendered.fades);
}

TEST_F(RenderedAnswer, LetsWhatOthersCanMoveFadeWhenTheServerIsSilentAlsoAtRest) {
  receive_pad(0.002);
  newest.answer.model.surfaces[0].others_move_it = true;
  expect_to_fade(-0.003, 3);
}

TEST_F(RenderedAnswer, LetsAMassThatOthersCanMoveFadeWhenTheServerIsSilent) {
  receive(0);
  newest.answer.model.mass = {.id = 1,
                              .stiffness_N_per_m = 500,
                              // Too heavy to move in the time that is looked at.
                              .body = {.mobility_per_kg = 1e-4 * Eigen::Matrix3d::Identity()},
                              .radius_m = 1,
                              .others_move_it = true};
  newest.answer.model.has_mass = true;
  EXPECT_NEAR(settled_at(-0.01), 5, 0.01);
  EXPECT_TRUE(rendered.fades);
  share = 0.5;
  EXPECT_NEAR(at(-0.01), 2.5, 0.01);
  share = 0;
  EXPECT_NEAR(at(-0.01), 0, 1e-9);
}

}  // namespace
}  // namespace forcebound::client
