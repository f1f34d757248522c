#include "forcebound/server/environment/tool_parser.hpp"

#include <gmock/gmock.h>

#include <string>

#include "forcebound/scene/tool/tool.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kTable =
    "[[object]]\nname = 'table'\nshape = { kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }\n"
    "effects = ['surface']\nsurface = { stiffness_N_per_m = 500 }\n";

/// A scene file, and meshes beside it.
class ToolParser : public testing::Test {
 protected:
  [[nodiscard]] std::shared_ptr<const scene::Scene> scene(const std::string& tool, int axes = 3,
                                                          const std::string& rest = kTable) const {
    return parse_scene(
        "[scene]\nname = 't'\ndescription = ''\ndegrees_of_freedom = " + std::to_string(axes) + "\n" + tool + rest,
        folder.file("t.toml"));
  }

  [[nodiscard]] std::string error_of(const std::string& tool, int axes = 3, const std::string& rest = kTable) const {
    try {
      (void)scene(tool, axes, rest);
    } catch (const SceneError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text.substr(text.find("t.toml"));
    }
    return "no error";
  }

  [[nodiscard]] static std::string part(const std::string& shape, const std::string& name = "a") {
    return "[[tool.part]]\nname = '" + name + "'\nshape = { " + shape + " }\n";
  }

  test::TemporaryFolder folder;
};

TEST_F(ToolParser, TakesATipAndSeveralParts) {
  const auto made = scene("[tool]\ntip_m = [0, 0.01, -0.1]\nspacing_m = 0.01\n" +
                          part("kind = 'box', center_m = [0, 0, 0.02], size_m = [0.01, 0.01, 0.01]", "head") +
                          part("kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.003", "nose"));
  EXPECT_EQ(made->facts().tool_m, control::Vector(scene::Point(0, 0.01, -0.1)));
  ASSERT_NE(made->facts().tool, nullptr);
  EXPECT_EQ(made->facts().tool->points().size(), 9U);
  EXPECT_EQ(made->facts().tool->reach_of_points_m(), 0.003 + scene::Tool::kAhead_m);
  EXPECT_THAT(explain(*made), HasSubstr("touches with 9 points, all within 26 mm of that"));
  EXPECT_EQ(suggested_hand(made).device, "arm-6dof");
}

TEST_F(ToolParser, TakesATipAloneForAnOrdinaryPoint) {
  const auto made = scene("[tool]\ntip_m = [0, 0, -0.1]\n");
  EXPECT_EQ(made->facts().tool_m, control::Vector(scene::Point(0, 0, -0.1)));
  EXPECT_EQ(made->facts().tool, nullptr);
}

TEST_F(ToolParser, TakesAClosedMeshBesideTheScenesFile) {
  test::write_file(folder.file("wedge.obj"),
                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto made = scene("[tool]\nspacing_m = 0.005\n" + part("kind = 'mesh', file = 'wedge.obj', scale = 0.02"));
  EXPECT_GT(made->facts().tool->points().size(), 20U);
  EXPECT_NEAR(made->facts().tool->reach_m(), 0.02, 1e-9);
}

TEST_F(ToolParser, RefusesWhatIsNoTool) {
  EXPECT_THAT(error_of("[tool]\n"), HasSubstr("tool: 'tip_m' is missing"));
  EXPECT_THAT(error_of("[tool]\ntip_m = [0, 0, -0.6]\n"), HasSubstr("tip_m[2] must be >= -0.5 and <= 0.5, got -0.6"));
  EXPECT_THAT(error_of("[tool]\ntip_m = [0]\n", 1, ""), HasSubstr("needs a scene with degrees_of_freedom = 3"));
  EXPECT_THAT(error_of("[tool]\nspacing_m = 0\n"), HasSubstr("spacing_m must be > 0"));
  EXPECT_THAT(error_of("[tool]\n" + part("kind = 'sphere', center_m = [0, 0, 0.4], radius_m = 0.2")),
              StartsWith("t.toml:8: part 'a': a tool for a hand lies within 0.5 m of its tip, got a point at"));
  EXPECT_THAT(
      error_of("[tool]\nspacing_m = 1e-6\n" + part("kind = 'box', center_m = [0, 0, 0], size_m = [0.1, 0.1, 0.1]")),
      StartsWith("t.toml:9: part 'a': a part with points spacing_m 1e-06 apart has more than 10000"));
  EXPECT_THAT(error_of("[tool]\n" + part("kind = 'cavity', center_m = [0, 0, 0], radius_m = 0.1")),
              HasSubstr("must be one of: box, capsule, cylinder, mesh, sphere, got 'cavity'"));
}

TEST_F(ToolParser, RefusesAMeshThatIsOpen) {
  test::write_file(folder.file("flat.obj"), "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  EXPECT_THAT(error_of("[tool]\n" + part("kind = 'mesh', file = 'flat.obj'")),
              HasSubstr("a tool's mesh must be closed, got 1 triangle"));
}

TEST_F(ToolParser, RefusesWhatItsPointsDoNotFeel) {
  const std::string ball = "[tool]\n" + part("kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.003");
  std::string rough = kTable;
  rough.replace(rough.find("['surface']"), 11, "['surface', 'texture']");
  EXPECT_THAT(error_of(ball, 3, rough + "texture = { amplitude_N = 0.2, wavelength_m = 0.002 }\n"),
              HasSubstr("feels no texture, got that of object 'table'"));
  const std::string tissue =
      "[[tissue]]\nname = 'pad'\nyoung_Pa = 9000\npoisson = 0.3\n"
      "held = { through_m = [0, 0, -0.02], normal = [0, 0, 1] }\n"
      "shape = { kind = 'block', center_m = [0, 0, -0.01], size_m = [0.04, 0.04, 0.02], cells = [4, 4, 2] }\n";
  EXPECT_THAT(error_of(ball, 3, tissue), HasSubstr("touches objects alone, got 'pad'"));
}

}  // namespace
}  // namespace forcebound::server
