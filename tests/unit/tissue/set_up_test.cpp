#include "forcebound/tissue/set_up.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

double predicted_s(const std::array<std::size_t, 3>& cubes, bool large_motion) {
  const TetrahedralMesh mesh(test::tetrahedra_of({.cubes = cubes}));
  return predicted_set_up_s(mesh, nodes_below(mesh, {0, 0, 0}, {0, 0, 1}), large_motion);
}

TEST(SetUp, OfAFinerMeshTakesLonger) {
  double before_s = 0;
  for (const std::size_t cubes : {1U, 2U, 4U, 6U, 8U}) {
    const double now_s = predicted_s({cubes, cubes, cubes}, false);
    EXPECT_GT(now_s, before_s);
    EXPECT_LT(now_s, kSetUpMost_s);
    EXPECT_GT(now_s, predicted_s({cubes, cubes, cubes}, true)) << "which has no compliance";
    before_s = now_s;
  }
  EXPECT_LT(predicted_s({16, 16, 16}, false), kSetUpMost_s);
  EXPECT_GT(predicted_s({24, 24, 24}, false), kSetUpMost_s);
  EXPECT_LT(predicted_s({15, 15, 7}, false), 0.1 * kSetUpMost_s) << "as the scene palpation";
}

// Of one cube on its bed the four free nodes are all coupled.
TEST(SetUp, OfACubeIsThatOfItsFactors) {
  constexpr double kFull = 27 * (16 + 9 + 4 + 1);
  constexpr double kEntries = 9 * (3 + 2 + 1) + 4 * 6;
  EXPECT_NEAR(predicted_s({1, 1, 1}, true), 1.5e-9 * kFull, 1e-15);
  EXPECT_NEAR(predicted_s({1, 1, 1}, false), 1.5e-9 * kFull + 0.2e-9 * 2 * kEntries * 3 * 4, 1e-15);
}

TEST(SetUp, SaysHowLongItWouldTake) {
  const TetrahedralMesh mesh(test::tetrahedra_of({.cubes = {1, 1, 1}}));
  EXPECT_NO_THROW(check_set_up(mesh, 30));
  EXPECT_THAT([&] { check_set_up(mesh, 87.3); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("would take about 87 s: expected")));
  EXPECT_NO_THROW(check_tetrahedra(kTetrahedraMost));
  EXPECT_THAT([] { check_tetrahedra(1.5e6); },
              testing::ThrowsMessage<std::runtime_error>("has 1500000 tetrahedra: expected at most 100000"));
}

}  // namespace
}  // namespace forcebound::tissue
