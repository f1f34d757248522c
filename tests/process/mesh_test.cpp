#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "tests/process/passive.hpp"
#include "tests/process/programs.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

struct Vertex {
  double x = 0;
  double y = 0;
  double z = 0;
};

/// The vertex of an OBJ file that is highest along z, and how tall the mesh is.
struct Top {
  Vertex at;
  double height = 0;
};

Top top_of(const std::filesystem::path& obj) {
  std::ifstream file(obj);
  Top top{.at = {.z = -std::numeric_limits<double>::infinity()}};
  double lowest = std::numeric_limits<double>::infinity();
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    Vertex vertex;
    if (!(words >> kind >> vertex.x >> vertex.y >> vertex.z) || kind != "v") continue;
    if (vertex.z > top.at.z) top.at = vertex;
    lowest = std::min(lowest, vertex.z);
  }
  top.height = top.at.z - lowest;
  return top;
}

/// A server that simulates the mesh, 80 mm tall with its highest vertex in the origin, and an omni that strokes it
/// there:
///
///     client with omni --- server with the mesh
void expect_felt(const std::filesystem::path& obj, const std::string& kind) {
  SCOPED_TRACE(obj.string());
  const Top top = top_of(obj);
  const double scale = 0.08 / top.height;
  const TemporaryFolder folder;
  std::filesystem::copy_file(obj, folder.file("mesh.obj"));
  std::ofstream(folder.file("mesh.toml"))
      << "[scene]\nname = \"mesh\"\ndescription = \"\"\ndegrees_of_freedom = 3\n"
      << "[[object]]\nname = \"mesh\"\neffects = [\"surface\", \"friction\"]\n"
      << "[object.shape]\n"
      << kind << "\nfile = \"mesh.obj\"\nscale = " << std::to_string(scale) << "\noffset_m = [" << -top.at.x * scale
      << ", " << -top.at.y * scale << ", " << -top.at.z * scale << "]\n"
      << "[object.surface]\nstiffness_N_per_m = 600\n"
      << "[object.friction]\nstatic_coefficient = 0.3\ndynamic_coefficient = 0.2\n";
  const Ran explained = run(kServer, {"--scene", folder.file("mesh.toml"), "--explain"});
  ASSERT_EQ(explained.exit_code, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr("triangles"));

  Server server({"--scene", folder.file("mesh.toml")});
  Client client(server.address(), {"--duration", "4", "--device", "omni", "--operator",
                                   "stroke:length_m=0.01,depth_m=0.006", "--law", "fba-exact"});
  EXPECT_EQ(client.wait(30s), 0) << client.err();
  const nlohmann::json summary = client.summary();
  EXPECT_GT(summary["contact_ticks"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
}

TEST(AMesh, ElsewhereNeedsAFolderThatIsAllowed) {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  write_file(elsewhere.file("mesh.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  write_file(folder.file("mesh.toml"),
             "[scene]\nname = \"mesh\"\ndescription = \"\"\ndegrees_of_freedom = 3\n"
             "[[object]]\nname = \"mesh\"\neffects = [\"surface\"]\nsurface = { stiffness_N_per_m = 600 }\n"
             "shape = { kind = \"mesh\", scale = 0.1, file = \"" +
                 elsewhere.file("mesh.obj") + "\" }\n");
  const Ran refused = run(kServer, {"--scene", folder.file("mesh.toml"), "--explain"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_EQ(lines(refused.err), 1U);
  EXPECT_THAT(refused.err,
              testing::AllOf(HasSubstr(folder.file("mesh.toml") + ":9: "), HasSubstr("lies outside of '")));
  const Ran allowed =
      run(kServer, {"--scene", folder.file("mesh.toml"), "--explain", "--scene-files", elsewhere.path().string()});
  EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
  EXPECT_THAT(unwrapped(allowed.out), HasSubstr("4 triangles"));
}

TEST(AMesh, FromTheRegistryLoadsExplainsAndIsFelt) {
  const std::filesystem::path bunny = FORCEBOUND_BUNNY;
  if (!std::filesystem::exists(bunny)) GTEST_SKIP() << "no bunny: node, npm or the network are missing";
  expect_felt(bunny, "kind = \"mesh\"");
}

TEST(AMesh, FromTheRegistryIsFeltAsADistanceField) {
  const std::filesystem::path bunny = FORCEBOUND_BUNNY;
  if (!std::filesystem::exists(bunny)) GTEST_SKIP() << "no bunny: node, npm or the network are missing";
  expect_felt(bunny, "kind = \"distance_field\"\nspacing_m = 0.002");
}

TEST(AMesh, OfTheRecordedDataLoadsExplainsAndIsFelt) {
  const auto spot = recorded_data("meshes/spot.obj");
  if (!spot) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  expect_felt(*spot, "kind = \"mesh\"");
}

}  // namespace
}  // namespace forcebound::test
