#include "tests/tools/lab/soak/lying_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace forcebound::lab {
namespace {

TEST(LyingModel, IsMostlySoundSoThatItIsRenderedAndAsksForMoreThanAnyDeviceGives) {
  sim::Draw draw(1);
  wire::EnvironmentForce answer;
  answer.position = control::Vector::Zero(3);
  int sound = 0;
  int unsound = 0;
  double most_N = 0;
  double farthest_m = 0;
  for (int i = 0; i < 1000; ++i) {
    const local_model::LocalModel model = lying_model(draw, answer);
    if (!local_model::is_sound(model)) {
      ++unsound;
      continue;
    }
    ++sound;
    most_N = std::max(most_N, model.force_N().norm());
    if (model.has_mass) farthest_m = std::max(farthest_m, model.mass.place_m.norm());
  }
  EXPECT_GT(sound, 600);
  EXPECT_GT(unsound, 50);
  EXPECT_GT(most_N, 1e5);
  EXPECT_GT(farthest_m, 50);
}

}  // namespace
}  // namespace forcebound::lab
