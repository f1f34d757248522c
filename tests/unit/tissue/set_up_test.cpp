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
  EXPECT_GT(predicted_s({16, 16, 16}, false), kSetUpMost_s);
  EXPECT_LT(predicted_s({10, 10, 4}, false), 0.1 * kSetUpMost_s) << "as the scene palpation";
}

// Of one cube on its bed four nodes are free. All but two of them, across the top, are coupled: whether the factor has
// an entry for those two, which it has in the second factorisation in any case, is up to the order of elimination.
TEST(SetUp, OfACubeIsThatOfItsFactors) {
  constexpr double kSecondsEach = 1.5e-9;
  constexpr double kSparse = 27 * (9 + 9 + 4 + 1);
  constexpr double kFull = 27 * (16 + 9 + 4 + 1);
  constexpr double kSparseEntries = 9 * (2 + 2 + 1) + 4 * 6;
  constexpr double kFullEntries = 9 * (3 + 2 + 1) + 4 * 6;
  const double large_motion_s = predicted_s({1, 1, 1}, true);
  EXPECT_GE(large_motion_s, kSecondsEach * kSparse * (1 - 1e-9));
  EXPECT_LE(large_motion_s, kSecondsEach * kFull * (1 + 1e-9));
  const double small_motion_s = predicted_s({1, 1, 1}, false);
  const auto solves = [&](double entries) { return 2 * entries * 3 * 8 + 2 * kFullEntries * 64; };
  EXPECT_GE(small_motion_s, kSecondsEach * (kSparse + kFull + solves(kSparseEntries)) * (1 - 1e-9));
  EXPECT_LE(small_motion_s, kSecondsEach * (kFull + kFull + solves(kFullEntries)) * (1 + 1e-9));
}

TEST(SetUp, OfManyTetrahedraAroundOneNodeIsRefused) {
  // Around an edge on a bed, thousands of wedges.
  constexpr int kWedges = 6000;
  TetrahedralSoup soup;
  soup.name = "fan";
  soup.nodes = {{0, 0, 0}, {0, 0, 1}};
  soup.nodes.reserve(kWedges + 2);
  soup.tetrahedra.reserve(kWedges);
  for (int i = 0; i < kWedges; ++i) {
    const double angle = 2 * M_PI * i / kWedges;
    soup.nodes.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    const auto next = static_cast<std::size_t>((i + 1) % kWedges);
    soup.tetrahedra.push_back({.nodes = {0, static_cast<std::size_t>(i) + 2, next + 2, 1}});
  }
  const TetrahedralMesh mesh(soup);
  EXPECT_TRUE(std::isinf(predicted_set_up_s(mesh, {}, false)));
  EXPECT_THAT([&] { check_set_up(mesh, predicted_set_up_s(mesh, {}, false)); },
              testing::ThrowsMessage<std::runtime_error>(
                  "fan: its set-up would take far too long: expected at most 30 s, so a coarser mesh"));
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
