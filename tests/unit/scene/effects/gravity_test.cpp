#include "forcebound/scene/effects/gravity.hpp"

#include <gtest/gtest.h>

#include "tests/support/field_checks.hpp"

namespace forcebound::scene {
namespace {

std::unique_ptr<Effect> gravity() {
  return gravity_effect().make({{"mass_kg", 0.1}, {"gravity_m_per_s2", 9.81}, {"direction", Point(0, 0, -1)}});
}

TEST(Gravity, IsMassTimesGravityAlongItsDirection) {
  EXPECT_LT((test::force_N(*gravity(), {.position_m = {3, 4, 5}}) - Point(0, 0, -0.981)).norm(), 1e-15);
}

TEST(Gravity, ReturnsNoEnergyAroundALoop) {
  EXPECT_LT(test::work_around(*gravity(), test::crooked_loop(Point::Zero())).share(), 1e-12);
}

}  // namespace
}  // namespace forcebound::scene
