#include "forcebound/client/commands/identify/encoder_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace forcebound::client::commands::identify {
namespace {

TEST(EncoderGrid, FindsTheStepOfReadingsThatJumpSeveralSteps) {
  constexpr double kStep = 23.45678e-6;
  EncoderGrid grid;
  for (const int count : {3, 9, 24, 18, -30, 1200, 1185}) grid.add(kStep * count);
  ASSERT_TRUE(grid.step());
  EXPECT_NEAR(*grid.step() / (3 * kStep), 1, 1e-12) << "all of them are multiples of three";
  grid.add(kStep * 1184);
  EXPECT_NEAR(*grid.step() / kStep, 1, 1e-12);
}

TEST(EncoderGrid, KnowsNoStepBeforeTwoDistinctReadings) {
  EncoderGrid grid;
  for (int i = 0; i < 5; ++i) grid.add(0.25);
  EXPECT_FALSE(grid.step());
  EXPECT_EQ(grid.changes(), 0U);
}

TEST(EncoderGrid, RefusesReadingsOnNoGrid) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 1e-5);
  EncoderGrid grid;
  for (int i = 0; i < 200; ++i) grid.add(noise(random));
  EXPECT_FALSE(grid.step());
}

}  // namespace
}  // namespace forcebound::client::commands::identify
