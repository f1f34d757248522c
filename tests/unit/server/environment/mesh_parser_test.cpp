#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/support/vector_of.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;
using test::vector_of;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A scene file with one mesh beside it.
class MeshParser : public testing::Test {
 protected:
  [[nodiscard]] std::shared_ptr<const scene::Scene> scene(const std::string& shape,
                                                          const std::string& effects = "'surface'",
                                                          const std::string& rest = "") const {
    return parse_scene(
        "[scene]\nname = 'm'\ndescription = ''\ndegrees_of_freedom = 3\n[[object]]\nname = 'it'\n"
        "shape = { " +
            shape + " }\neffects = [" + effects + "]\nsurface = { stiffness_N_per_m = 1000 }\n" + rest,
        folder.file("scene.toml"));
  }

  [[nodiscard]] std::string error_of(const std::string& shape) const {
    try {
      (void)scene(shape);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TemporaryFolder folder;
};

TEST_F(MeshParser, TakesAMeshBesideTheScenesFileInItsScaleAndPlace) {
  test::write_file(folder.file("corner.obj"), kTetrahedron);
  const auto made = scene("kind = 'mesh', file = 'corner.obj', scale = 0.1, offset_m = [0, 0, 0.01]");
  scene::SceneState state(made, 3);
  // Through the bottom, which looks down at z = 0.01.
  (void)state.answer(vector_of({0.02, 0.02, 0.009}), milliseconds{1});
  const scene::Answer answer = state.answer(vector_of({0.02, 0.02, 0.012}), milliseconds{2});
  EXPECT_NEAR(answer.force[2], -2, 1e-6);
  EXPECT_NEAR(answer.penetration_m, 0.002, 1e-9);
  EXPECT_THAT(explain(*made), HasSubstr("object 'it': mesh, file corner.obj, scale 0.1"));
  EXPECT_THAT(explain(*made), HasSubstr("4 triangles"));
}

TEST_F(MeshParser, TurnsAMeshAfterItsScaleAndBeforeItsOffset) {
  test::write_file(folder.file("corner.obj"), kTetrahedron);
  // The bottom, which looked down at z = 0, stands upright at x = 0.01 and looks along -x.
  const auto made =
      scene("kind = 'mesh', file = 'corner.obj', scale = 0.1, rotation_deg = [0, 90, 0], offset_m = [0.01, 0, 0]");
  scene::SceneState state(made, 3);
  (void)state.answer(vector_of({0.009, 0.02, -0.02}), milliseconds{1});
  const scene::Answer answer = state.answer(vector_of({0.012, 0.02, -0.02}), milliseconds{2});
  EXPECT_NEAR(answer.force[0], -2, 1e-6);
  EXPECT_NEAR(answer.penetration_m, 0.002, 1e-9);
  EXPECT_THAT(explain(*made), HasSubstr("scale 0.1, rotation_deg [0, 90, 0], offset_m [0.01, 0, 0]"));
  EXPECT_THAT(explain(*made),
              HasSubstr("box:        [0.01, 0, -0.1] to [0.11, 0.1, 0] m,\n              100 x 100 x 100 mm\n"));
}

TEST_F(MeshParser, RefusesAnInvalidPlacement) {
  test::write_file(folder.file("corner.obj"), kTetrahedron);
  const std::string mesh = "kind = 'mesh', file = 'corner.obj', ";
  const std::string place = folder.file("scene.toml") + ":7: object 'it', shape: ";
  EXPECT_EQ(error_of(mesh + "rotation_deg = [90, 0]"),
            place + "rotation_deg must have 3 numbers in this scene, got [90, 0]");
  EXPECT_EQ(error_of(mesh + "rotation_deg = 90"), place + "rotation_deg must be a list, got 90");
  EXPECT_EQ(error_of(mesh + "rotation_deg = [nan, 0, 0]"), place + "rotation_deg must be a finite number, got nan");
  EXPECT_EQ(error_of(mesh + "scale = 0"), place + "scale must be > 0 and <= 1e+09, got 0");
  EXPECT_THAT(error_of(mesh + "rotation = [90, 0, 0]"),
              StartsWith(place + "unknown key 'rotation', did you mean 'rotation_deg'?"));
  EXPECT_THAT(error_of(mesh + "offset = [90, 0, 0]"),
              StartsWith(place + "unknown key 'offset', did you mean 'offset_m'?"));
}

TEST_F(MeshParser, FindsTheDistanceOnlyWhereAnEffectReaches) {
  test::write_file(folder.file("corner.obj"), kTetrahedron);
  const std::string shape = "kind = 'mesh', file = 'corner.obj', scale = 0.1";
  scene::SceneState deaf(scene(shape), 3);
  EXPECT_EQ(deaf.answer(vector_of({0.02, 0.02, -0.005}), milliseconds{1}).force.norm(), 0);
  scene::SceneState drawn(scene(shape, "'surface', 'magnet'", "magnet = { force_N_max = 1, range_m = 0.015 }"), 3);
  EXPECT_NEAR(drawn.answer(vector_of({0.02, 0.02, -0.005}), milliseconds{1}).force[2], 1, 1e-6);
}

TEST_F(MeshParser, TakesTheSameMeshAsADistanceField) {
  test::write_file(folder.file("corner.obj"), kTetrahedron);
  scene::SceneState state(scene("kind = 'distance_field', file = 'corner.obj', scale = 0.1, spacing_m = 0.004"), 3);
  EXPECT_NEAR(state.answer(vector_of({0.02, 0.02, 0.002}), milliseconds{1}).force[2], -2, 0.01);
}

TEST_F(MeshParser, NamesSceneLineAndFileAndTheirLine) {
  EXPECT_THAT(error_of("kind = 'mesh', file = 'gone.obj'"),
              StartsWith(folder.file("scene.toml") + ":7: object 'it', shape: " + folder.file("gone.obj")));
  test::write_file(folder.file("bad.obj"), "v 0 0 0\nv 1 0 zero\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(error_of("kind = 'mesh', file = 'bad.obj'"),
              StartsWith(folder.file("scene.toml") + ":7: object 'it', shape: " + folder.file("bad.obj") + ":2"));
  test::write_file(folder.file("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(error_of("kind = 'distance_field', file = 'open.obj', spacing_m = 0.1"), HasSubstr("open.obj"));
  EXPECT_THAT(error_of("kind = 'mesh', file = 'corner.ply'"), HasSubstr("a mesh is an .obj, .off or .stl file"));
}

TEST_F(MeshParser, KeepsTheRequestedDetail) {
  std::ofstream file(folder.file("ball.obj"));
  const test::Soup ball = test::ball(0.05, 10);
  for (const scene::Point& v : ball.vertices) file << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const scene::Triangle& t : ball.triangles)
    file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  file.close();
  EXPECT_THAT(explain(*scene("kind = 'mesh', file = 'ball.obj'")), HasSubstr("360 triangles"));
  EXPECT_THAT(explain(*scene("kind = 'mesh', file = 'ball.obj', detail = 0.25")), HasSubstr("90 triangles"));
  EXPECT_THAT(explain(*scene("kind = 'distance_field', file = 'ball.obj', detail = 0.25, spacing_m = 0.01")),
              HasSubstr("90 triangles"));
  for (const std::string wrong : {"0", "1.5", "-1"}) {
    EXPECT_THAT(error_of("kind = 'mesh', file = 'ball.obj', detail = " + wrong),
                testing::AllOf(StartsWith(folder.file("scene.toml") + ":7: "), HasSubstr("detail must be")));
  }
  test::write_file(folder.file("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(error_of("kind = 'mesh', file = 'open.obj', detail = 0.5"),
              testing::AllOf(StartsWith(folder.file("scene.toml") + ":7: "), HasSubstr("closed")));
}

TEST_F(MeshParser, TurnsAProfileOnALathe) {
  scene::SceneState state(
      scene("kind = 'lathe', profile_m = [[0, 0], [0.03, 0], [0.03, 0.05], [0, 0.05]], segments = 8"), 3);
  (void)state.answer(vector_of({0, 0, 0.06}), milliseconds{1});
  EXPECT_NEAR(state.answer(vector_of({0.001, 0.002, 0.049}), milliseconds{2}).force[2], 1, 1e-9);
  EXPECT_THAT(error_of("kind = 'lathe', profile_m = [[0, 0], [0.5], [0, 0.05]]"),
              HasSubstr("row 2 of profile_m must have 2 numbers, got 1"));
}

TEST_F(MeshParser, ReadsNoFileOutsideOfTheScenesFolder) {
  const test::TemporaryFolder other;
  test::write_file(other.file("corner.obj"), kTetrahedron);
  const std::string outside = other.file("corner.obj");
  const std::string file = ", file = '" + outside + "'";
  const std::string refusal = folder.file("scene.toml") + ":7: object 'it', shape: " + outside + ": lies outside of '" +
                              folder.path().string() + "'";
  for (const std::string shape : {"kind = 'mesh'", "kind = 'distance_field', spacing_m = 0.004, scale = 0.1"}) {
    EXPECT_THAT(error_of(shape + file), StartsWith(refusal));
  }
  EXPECT_THAT(error_of("kind = 'height_field', origin_m = [0, 0, 0], spacing_m = 1, file = '/etc/shadow'"),
              HasSubstr("/etc/shadow: lies outside of"))
      << "and not what its first line is";
}

TEST_F(MeshParser, ReadsFilesOfFoldersThatAreAllowed) {
  const test::TemporaryFolder other;
  test::write_file(other.file("corner.obj"), kTetrahedron);
  const std::array folders{other.path().string()};
  const std::string text =
      "[scene]\nname = 'm'\ndescription = ''\ndegrees_of_freedom = 3\n[[object]]\nname = 'it'\n"
      "shape = { kind = 'mesh', file = '" +
      other.file("corner.obj") + "' }\neffects = ['surface']\nsurface = { stiffness_N_per_m = 1000 }\n";
  const auto made = parse_scene(text, folder.file("scene.toml"), scene::Registry::standard(), {}, folders);
  EXPECT_THAT(explain(*made), HasSubstr("4 triangles"));
}

TEST_F(MeshParser, RecordedMeshIsFelt) {
  const auto file = recorded_data("meshes/spot.obj");
  if (!file) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  std::filesystem::copy_file(*file, folder.file("spot.obj"));
  const auto made = scene("kind = 'mesh', file = 'spot.obj', scale = 0.05");
  scene::SceneState state(made, 3);
  int touched = 0;
  for (int i = 0; i < 2000; ++i) {
    const double depth = 0.12 - 1e-4 * i;
    touched += state.answer(vector_of({0, depth, 0}), milliseconds{i}).penetration_m > 0;
  }
  EXPECT_GT(touched, 100);
  EXPECT_EQ(state.faults().quarantined, 0U);
}

}  // namespace
}  // namespace forcebound::server
