#include "forcebound/scene/geometry/height_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/vector_of.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

const test::TemporaryFolder kFolder;

std::shared_ptr<const scene::Scene> hill_scene(const std::string& heights) {
  return parse_scene(
      "[scene]\nname = 'x'\ndescription = ''\ndegrees_of_freedom = 3\n[[object]]\nname = 'hill'\n"
      "effects = ['surface']\n[object.surface]\nstiffness_N_per_m = 100\n[object.shape]\n"
      "kind = 'height_field'\norigin_m = [0, 0, 0]\nspacing_m = 0.1\n" +
          heights + "\n",
      kFolder.file("x.toml"));
}

std::string height_field_error(const std::string& heights) {
  try {
    (void)hill_scene(heights);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no error";
}

std::string error_of_file(const std::string& text) {
  std::ofstream(kFolder.file("hill.csv")) << text;
  return height_field_error("file = 'hill.csv'");
}

double force_N_at(const std::shared_ptr<const scene::Scene>& scene, double x, double y, double z) {
  return scene::SceneState(scene, 3).answer(test::vector_of({x, y, z}), time::Nanoseconds{0}).force[2];
}

TEST(HeightFieldParser, RowsFollowEachOtherAlongY) {
  const auto scene = hill_scene("heights_m = [[0, 0, 0], [0.02, 0.02, 0.02]]");
  EXPECT_EQ(force_N_at(scene, 0.1, 0.0999, 0.0201), 0);
  EXPECT_GT(force_N_at(scene, 0.1, 0.0999, 0.0199), 0);
  EXPECT_EQ(force_N_at(scene, 0.1, 0.0001, 0.0199), 0);
}

TEST(HeightFieldParser, ReadsATableBesideTheScene) {
  ASSERT_EQ(error_of_file("0, 0,0\r\n0.02,\t2e-2,0.02\n\n"), "no error");
  const auto from_file = hill_scene("file = 'hill.csv'");
  const auto written = hill_scene("heights_m = [[0, 0, 0], [0.02, 0.02, 0.02]]");
  for (const double y : {0.02, 0.05, 0.07}) {
    EXPECT_GT(force_N_at(written, 0.1, y, -0.001), 0);
    EXPECT_EQ(force_N_at(from_file, 0.1, y, -0.001), force_N_at(written, 0.1, y, -0.001));
  }
}

TEST(HeightFieldParser, RefusesRowsThatDoNotFit) {
  EXPECT_EQ(height_field_error("heights_m = [[0, 0], [0, 0, 0]]"),
            kFolder.file("x.toml") +
                ":14: object 'hill', shape: row 2 of heights_m must have 2 numbers like the first, got 3");
  EXPECT_THAT(height_field_error("heights_m = [[0, 0]]"),
              EndsWith("a height_field needs at least 2 rows of 2 numbers"));
  EXPECT_THAT(height_field_error("heights_m = [[0], [0]]"),
              EndsWith("a height_field needs at least 2 rows of 2 numbers"));
  EXPECT_THAT(height_field_error("heights_m = []"), EndsWith("a height_field needs at least 2 rows of 2 numbers"));
  EXPECT_THAT(height_field_error("heights_m = [0, 1]"), HasSubstr("row 1 of heights_m must be a list, got 0"));
  EXPECT_THAT(height_field_error("heights_m = [[0, nan], [0, 0]]"),
              HasSubstr("row 1 of heights_m must be a finite number"));
}

TEST(HeightFieldParser, RefusesATableWithItsLine) {
  const std::string place = kFolder.file("x.toml") + ":14: object 'hill', shape: file: " + kFolder.file("hill.csv");
  EXPECT_EQ(error_of_file("0,0\n0,zero\n"), place + ":2: must have finite numbers only, got 'zero'");
  EXPECT_EQ(error_of_file("0,0\n0,inf\n"), place + ":2: must have finite numbers only, got 'inf'");
  EXPECT_EQ(error_of_file("0,0\n0,0,0\n"), place + ":2: must have 2 numbers like the first, got 3");
  EXPECT_EQ(error_of_file("0,0\n0,\n"), place + ":2: must have finite numbers only, got ''");
  EXPECT_THAT(error_of_file(""), EndsWith("a height_field needs at least 2 rows of 2 numbers"));
  EXPECT_THAT(height_field_error("file = 'nowhere.csv'"), HasSubstr("nowhere.csv: cannot be read: No such file"));
}

TEST(HeightFieldParser, NeedsOneOfHeightsAndFile) {
  EXPECT_THAT(height_field_error(""), EndsWith("a height_field needs either 'heights_m' or 'file'"));
  EXPECT_THAT(height_field_error("heights_m = [[0, 0], [0, 0]]\nfile = 'x.csv'"),
              EndsWith("a height_field needs either 'heights_m' or 'file'"));
}

TEST(HeightFieldParser, DistinguishesReliefsInOnePlace) {
  const auto text = [](const std::string& heights) { return hill_scene(heights)->objects().front().shape_text; };
  EXPECT_THAT(text("heights_m = [[0, 0.5], [0, -0.25], [0, 0]]"), HasSubstr("heights_m 2 x 3 from -0.25 to 0.5"));
  EXPECT_NE(text("heights_m = [[0, 1], [0, 0]]"), text("heights_m = [[0, 0], [1, 0]]"));
}

}  // namespace
}  // namespace forcebound::server
