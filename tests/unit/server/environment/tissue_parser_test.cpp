#include "forcebound/server/environment/tissue_parser.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/explain.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string pad(const std::string& rest = "", const std::string& shape =
                                                  "{ kind = \"block\", center_m = [0, 0, -0.02], "
                                                  "size_m = [0.08, 0.08, 0.04], cells = [6, 6, 3] }") {
  return "[scene]\nname = \"pad\"\ndescription = \"\"\ndegrees_of_freedom = 3\n"
         "[[tissue]]\nname = \"pad\"\nshape = " +
         shape + "\nheld = { through_m = [0, 0, -0.04], normal = [0, 0, 1] }\nyoung_Pa = 10000\npoisson = 0.3\n" + rest;
}

auto refused(const std::string& what) {
  return testing::ThrowsMessage<SceneError>(AllOf(StartsWith("pad.toml:"), HasSubstr(what)));
}

/// Pressed from above the middle down to a depth, a motion a millisecond; the force at the end.
scene::Point press(scene::SceneState& state, double depth_m) {
  scene::Answer answer;
  for (int i = 0; i <= 100; ++i) {
    const scene::Point place_m(0.001, 0.002, 0.002 - (depth_m + 0.002) * i / 100);
    answer = state.answer(control::Vector(place_m), milliseconds(i));
  }
  return answer.force;
}

TEST(TissueParser, PushesBackMoreTheDeeperItIsPressed) {
  const auto scene = parse_scene(pad(), "pad.toml");
  scene::SceneState once(scene, 3);
  scene::SceneState twice(scene, 3);
  const scene::Point force_N = press(once, 0.001);
  EXPECT_GT(force_N.z(), 0.01);
  EXPECT_NEAR(press(twice, 0.002).z() / force_N.z(), 2, 0.2);
}

TEST(TissueParser, LargeMotionIsAskedForByName) {
  const auto scene = parse_scene(pad("large_motion = true\ncontact_stiffness_N_per_m = 500\n"), "pad.toml");
  scene::SceneState state(scene, 3);
  EXPECT_GT(press(state, 0.004).z(), 0.01);
  EXPECT_THAT(explain(*scene), HasSubstr("rotation"));
}

TEST(TissueParser, LargeMotionIsFeltByASphereThatIsAsStiffAsItsSkin) {
  const std::string sphere = "large_motion = true\nprobe_radius_m = 0.008\n";
  const auto force_N = [](const std::string& rest) {
    const auto scene = parse_scene(pad(rest), "pad.toml");
    scene::SceneState state(scene, 3);
    return press(state, -0.005).z();  // the centre above the surface
  };
  EXPECT_GT(force_N(sphere), 0.01);
  EXPECT_LT(force_N(sphere + "contact_stiffness_Pa_per_m = 1e6\n"), 0.5 * force_N(sphere));
  EXPECT_THAT(explain(*parse_scene(pad(sphere), "pad.toml")), HasSubstr("felt by a sphere of 0.008 m through a skin"));
  EXPECT_THAT([&] { parse_scene(pad(sphere + "contact_stiffness_Pa_per_m = 0\n"), "pad.toml"); },
              refused("13: tissue 'pad': contact_stiffness_Pa_per_m must be > 0, got 0"));
  EXPECT_THAT([&] { parse_scene(pad(sphere + "contact_stiffness_Pa_per_m = 1e9\n"), "pad.toml"); },
              refused("tissue 'pad': contact_stiffness_Pa_per_m must be > 0 and <= 274725274"));
  EXPECT_THAT([&] { parse_scene(pad("large_motion = true\nprobe_radius_m = 0.001\n"), "pad.toml"); },
              refused("5: tissue 'pad': block: a sphere of radius 0.001 m is too small beside edges of"));
}

/// A tetrahedron of 20 file units upright in a corner, its bottom held.
std::string corner(const test::TemporaryFolder& folder, const std::string& placement, const std::string& held) {
  test::write_file(folder.file("corner.msh"),
                   "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 20 0 0\n3 0 20 0\n4 0 0 40\n"
                   "$EndNodes\n$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n");
  return "[scene]\nname = 'c'\ndescription = ''\ndegrees_of_freedom = 3\n[[tissue]]\nname = 'c'\n"
         "shape = { kind = 'mesh', file = 'corner.msh', " +
         placement + " }\nheld = " + held + "\nyoung_Pa = 1e4\npoisson = 0.3\n";
}

TEST(TissueParser, PlacesAFileByScaleRotationAndOffsetAsMeshesAre) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("scene.toml");
  const auto scene = parse_scene(corner(folder, "scale = 0.001, rotation_deg = [0, 90, 0], offset_m = [0.1, 0, 0]",
                                        "{ through_m = [0.1, 0, 0], normal = [1, 0, 0] }"),
                                 file);
  const Eigen::AlignedBox3d box_m = scene->dynamic_models().front().dynamic_model->facts().bounds_m;
  EXPECT_LT((box_m.min() - scene::Point(0.1, 0, -0.02)).norm(), 1e-15) << "the height of 40 lies along x";
  EXPECT_LT((box_m.max() - scene::Point(0.14, 0.02, 0)).norm(), 1e-15);
  EXPECT_THAT(explain(*scene),
              AllOf(HasSubstr("box:        [0.1, 0, -0.02] to [0.14, 0.02, 0] m,\n              40 x 20 x 20 mm\n"),
                    HasSubstr("6 held"), testing::Not(HasSubstr("warning"))));
  EXPECT_THAT(explain(*parse_scene(corner(folder, "scale = 1", "{ through_m = [0, 0, 0], normal = [0, 0, 1] }"), file)),
              HasSubstr("warning: larger than 1 m for a hand; is a scale missing? (0.001 for mm)\n"));
  EXPECT_THAT([&] { parse_scene(corner(folder, "rotation_deg = [1, 2]", "{}"), file); },
              testing::ThrowsMessage<SceneError>(HasSubstr(
                  "scene.toml:7: tissue 'c', shape: rotation_deg must have 3 numbers in this scene, got [1, 2]")));
}

TEST(TissueParser, TurnsABlockAboutItsCentre) {
  const auto scene =
      parse_scene(pad("",
                      "{ kind = \"block\", center_m = [0.1, 0, -0.02], size_m = [0.08, 0.06, 0.04], cells = [4, 3, 2], "
                      "rotation_deg = [0, 0, 90] }"),
                  "pad.toml");
  const Eigen::AlignedBox3d box_m = scene->dynamic_models().front().dynamic_model->facts().bounds_m;
  EXPECT_LT((box_m.center() - scene::Point(0.1, 0, -0.02)).norm(), 1e-15);
  EXPECT_LT((box_m.sizes() - scene::Point(0.06, 0.08, 0.04)).norm(), 1e-15);
}

TEST(TissueParser, RefusalNamesTissueAndLine) {
  EXPECT_THAT([] { parse_scene(pad("poison = 0.4\n"), "pad.toml"); },
              refused("tissue 'pad': unknown key 'poison', did you mean 'poisson'?"));
  EXPECT_THAT([] { parse_scene(pad("contacts_max = 2.5\n"), "pad.toml"); }, refused("contacts_max must be a whole"));
  EXPECT_THAT([] { parse_scene(pad("probe_radius_m = 0.0001\n"), "pad.toml"); }, refused("is too small beside edges"));
  EXPECT_THAT([] { parse_scene(pad("", "{ kind = \"mesh\", file = \"none.msh\" }"), "pad.toml"); },
              refused("none.msh"));
  EXPECT_THAT(
      [] {
        parse_scene(pad("", "{ kind = \"block\", center_m = [0, 0, 0], size_m = [0.1, 0.1, 0.1], cells = [0, 1, 1] }"),
                    "pad.toml");
      },
      refused("cells must be whole numbers from 1 to 64, got [0, 1, 1]"));
  EXPECT_THAT(
      [] {
        parse_scene(pad("", "{ kind = \"block\", center_m = [0, 0, 1], size_m = [0.1, 0.1, 0.1], cells = [1, 1, 1] }"),
                    "pad.toml");
      },
      refused("held"));
}

TEST(TissueParser, UnderLargeMotionTheContactIsAsStiffAsItMayBe) {
  const auto stiffness_of = [](const std::string& rest) {
    return parse_scene(pad("large_motion = true\n" + rest), "pad.toml")
        ->dynamic_models()
        .front()
        .dynamic_model->facts()
        .stiffness_N_per_m;
  };
  EXPECT_EQ(stiffness_of(""), 1000);
  EXPECT_EQ(stiffness_of("contact_stiffness_N_per_m = 3000\n"), 3000);
  EXPECT_THAT([&] { stiffness_of("contact_stiffness_N_per_m = 2e4\n"); },
              refused("12: tissue 'pad': contact_stiffness_N_per_m must be > 0 and <= 10000, got 20000"));
}

TEST(TissueParser, GivesItsMaximumOfClients) {
  const auto shared_by = [](int clients, const std::string& rest) {
    std::string text = pad(rest);
    text.insert(text.find("[[tissue]]"), "shared = true\nclients_max = " + std::to_string(clients) + "\n");
    return parse_scene(text, "pad.toml")->facts().clients_max;
  };
  EXPECT_EQ(shared_by(16, ""), 16);
  const std::string sphere = "probe_radius_m = 0.01\ncontacts_max = 8\n";
  EXPECT_EQ(shared_by(9, sphere), 9);
  EXPECT_THAT([&] { shared_by(10, sphere); }, refused("'pad' has room for 9 clients, got clients_max 10"));
  EXPECT_EQ(shared_by(16, "probe_radius_m = 0.01\ncontacts_max = 4\n"), 16);
}

TEST(TissueParser, TheLiverLoadsAndPushesBack) {
  const auto file = recorded_data("meshes/liver.msh");
  if (!file) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  const test::TemporaryFolder folder;
  std::filesystem::copy_file(*file, folder.file("liver.msh"));
  // Some 130 mm wide at this scale; what lies below its middle is held.
  const auto scene = parse_scene(
      "[scene]\nname = \"liver\"\ndescription = \"\"\ndegrees_of_freedom = 3\n"
      "[[tissue]]\nname = \"liver\"\nyoung_Pa = 5000\npoisson = 0.4\n"
      "shape = { kind = \"mesh\", file = \"liver.msh\", scale = 0.02 }\n"
      "held = { through_m = [0, 0.02, 0], normal = [0, 1, 0] }\n",
      folder.file("liver.toml"));
  const scene::Point top_m = scene->dynamic_models().front().dynamic_model->facts().on_surface_m;
  scene::SceneState state(scene, 3);
  scene::Answer answer;
  for (int i = 0; i <= 100; ++i) {
    const scene::Point place_m = top_m + scene::Point(0, 0, 0.002 - 4e-5 * i);
    answer = state.answer(control::Vector(place_m), milliseconds(i));
  }
  EXPECT_GT(answer.penetration_m, 0);
  EXPECT_GT(answer.force[2], 0.001);
  EXPECT_EQ(state.faults().quarantined, 0U);
}

}  // namespace
}  // namespace forcebound::server
