#include "forcebound/control/transparent_law.hpp"

#include <gtest/gtest.h>

#include "tests/support/law_loop.hpp"

namespace forcebound::control {
namespace {

using test::LawLoop;
using test::to_matrix;
using test::to_vector;

TEST(TransparentLaw, AppliesWhateverIsAskedFor) {
  LawLoop loop("none", to_matrix({{4, 2}, {2, 10}}));
  for (const auto& request : {to_vector({1, 2}), to_vector({-1e300, 1e-300}), to_vector({0, 0})}) {
    EXPECT_EQ(loop.tick(to_vector({0, 0}), request), request);
  }
  EXPECT_EQ(loop.xi(), 1.0);
}

TEST(TransparentLaw, ShowsTheEnergyThatAnActiveForceMadeUp) {
  // b v^2 T = 30 mJ taken and f v T = 10 mJ returned on each tick after the first.
  LawLoop loop("none", to_matrix({{30}}));
  for (int i = 0; i <= 100; ++i) loop.tick(i * 1e-3, 10.0);
  EXPECT_NEAR(loop.energy_J(), 100 * (30e-3 - 10e-3), 1e-12);
  for (int i = 0; i < 100; ++i) loop.tick((101 + i) * 1e-3, 100.0);
  EXPECT_NEAR(loop.energy_J(), 2 + (30e-3 - 10e-3) + 99 * (30e-3 - 100e-3), 1e-12);
  EXPECT_LT(loop.energy_J(), 0.0);
}

}  // namespace
}  // namespace forcebound::control
