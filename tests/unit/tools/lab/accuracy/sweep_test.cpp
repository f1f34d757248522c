#include "tests/tools/lab/accuracy/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/auto_wall.hpp"

namespace forcebound::lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ParseSweep, SeparatesAtCommasOutsideOfBracketsAndQuotes) {
  EXPECT_EQ(parse_sweep("a.b=1,2,3").key, "a.b");
  EXPECT_THAT(parse_sweep("a.b=1,2,3").values, ElementsAre("1", "2", "3"));
  EXPECT_THAT(parse_sweep("a=[4, 4, 2],[8,8,4]").values, ElementsAre("[4, 4, 2]", "[8,8,4]"));
  EXPECT_THAT(parse_sweep("a='x,y',{ b = 1, c = 2 }").values, ElementsAre("'x,y'", "{ b = 1, c = 2 }"));
}

TEST(ParseSweep, RefusesInvalidText) {
  EXPECT_THROW((void)parse_sweep("a"), std::invalid_argument);
  EXPECT_THROW((void)parse_sweep("=1"), std::invalid_argument);
  EXPECT_THROW((void)parse_sweep("a="), std::invalid_argument);
}

TEST(SpacingOf, FallsFromCoarseToFine) {
  EXPECT_EQ(spacing_of("tissue.pad.shape.cells", "[8, 8, 4]"), 0.125);
  EXPECT_EQ(spacing_of("object.o.shape.cell_m", "0.004"), 0.004);
  EXPECT_EQ(spacing_of("bodies.timestep_s", "0.001"), 0.001);
  EXPECT_EQ(spacing_of("tissue.pad.contacts_max", "8"), 0.125);
  EXPECT_EQ(spacing_of("object.o.surface.stiffness_N_per_m", "100"), 0.01);
  EXPECT_EQ(spacing_of("object.o.shape.detail", "0.25"), 2) << "edges are twice as long";
  EXPECT_EQ(spacing_of("tissue.pad.large_motion", "true"), std::nullopt);
}

TEST(SortToFine, TakesEitherOrderAndNoOther) {
  Sweep rising{"o.detail", {"0.25", "1"}};
  EXPECT_THAT(sort_to_fine(rising), ElementsAre(2, 1));
  EXPECT_THAT(rising.values, ElementsAre("0.25", "1"));
  Sweep falling{"o.detail", {"1", "0.25"}};
  EXPECT_THAT(sort_to_fine(falling), ElementsAre(2, 1));
  EXPECT_THAT(falling.values, ElementsAre("0.25", "1"));
  for (const Sweep& wrong :
       {Sweep{"n", {"1", "3", "2"}}, Sweep{"n", {"1", "1"}}, Sweep{"n", {"1"}}, Sweep{"n", {"1", "true"}}}) {
    Sweep sweep = wrong;
    EXPECT_THROW((void)sort_to_fine(sweep), std::invalid_argument) << testing::PrintToString(wrong.values);
  }
}

TEST(UsualSweep, NeedsSomethingWithLevels) {
  EXPECT_THROW((void)usual_sweep(server::scene_source("wall").text), std::invalid_argument);
  EXPECT_EQ(usual_sweep(server::scene_source("palpation").text).key, "tissue.pad.shape.cells");
  EXPECT_EQ(usual_sweep(server::scene_source("blocks").text).key, "bodies.timestep_s");
  const Sweep pad = usual_sweep(server::scene_source("soft_pad").text);
  EXPECT_EQ(pad.values.size(), 5U);
  for (const std::string& value : pad.values) EXPECT_TRUE(spacing_of(pad.key, value)) << value;
  EXPECT_DOUBLE_EQ(spacing_of(pad.key, "[ 15, 15, 5 ]").value_or(0), 1.0 / 15);
  const Sweep levels = usual_sweep(test::kAutoWall);
  EXPECT_EQ(levels.key, "object.wall.surface.stiffness_N_per_m");
  EXPECT_THAT(levels.values, ElementsAre("100", "200"));
  EXPECT_EQ(usual_sweep(server::scene_source("assembly").text).key, "body.peg in hole.iterations");
  EXPECT_EQ(usual_sweep("[[object]]\nname = 'cow'\nshape = { kind = 'mesh' }\n").key, "object.cow.shape.detail");
}

TEST(TightSolvers, AreForKeysOfASolverOnly) {
  EXPECT_FALSE(tight_solvers("bodies.timestep_s"));
  EXPECT_FALSE(tight_solvers("iterations"));
  EXPECT_FALSE(tight_solvers("tissue.x.iterations"));
  const auto tight = tight_solvers("bodies.tolerance");
  ASSERT_TRUE(tight);
  EXPECT_EQ(tight->newton.front().key, "bodies.iterations");
  EXPECT_EQ(tight->newton.front().value, "1000");
  EXPECT_THAT(tight->newton.back().value, HasSubstr("newton"));
  EXPECT_THAT(tight->cg.back().value, HasSubstr("cg"));
}

}  // namespace
}  // namespace forcebound::lab
