// Files that crashed, starved or silenced earlier versions, found by fuzzing.

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/mesh_file.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "tests/support/process.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class HostileFile : public testing::Test {
 protected:
  /// A copy in a folder of its own; empty where the data are absent.
  [[nodiscard]] std::string copy_of(const std::string& name) const {
    const auto file = recorded_data("hostile/" + name);
    if (!file) return {};
    std::filesystem::copy_file(*file, folder_.file(name), std::filesystem::copy_options::overwrite_existing);
    return folder_.file(name);
  }

  [[nodiscard]] std::string beside(const std::string& name) const { return folder_.file(name); }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(HostileFile, AMeshNamesAMaterialFileThatIsNotOpened) {
  const std::string file = copy_of("obj-mtllib-map_Kd.obj");
  if (file.empty()) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  EXPECT_EQ(load_mesh(file).triangles().size(), 1U);
}

TEST_F(HostileFile, AModelHasFacesOfVerticesThatItLacks) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const std::string scene = copy_of("mjcf-min-scene.toml");
  const std::string file = copy_of("mjcf-min-6-1-63.xml");
  if (scene.empty() || file.empty()) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  EXPECT_THAT([&] { (void)load_scene(scene); },
              ThrowsMessage<SceneError>(HasSubstr("mesh 'n': face must have numbers of its 4 vertices")));
}

TEST_F(HostileFile, AModelHasATextureOfGigabytes) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const std::string scene = copy_of("mjcf-texture-40000-scene.toml");
  const std::string file = copy_of("mjcf-texture-40000.xml");
  if (scene.empty() || file.empty()) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  std::filesystem::rename(file, beside("memdir.xml"));  // as the scene names it
  EXPECT_THAT([&] { (void)load_scene(scene); },
              ThrowsMessage<SceneError>(HasSubstr("texture 't': all textures must take at most 268435456 bytes")));
}

TEST_F(HostileFile, ASceneHasAKeyOfManyParts) {
  const std::string file = copy_of("toml-dotted-key-50000.toml");
  if (file.empty()) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  EXPECT_THAT([&] { (void)load_scene(file); }, ThrowsMessage<SceneError>(HasSubstr("a key must have at most 8 parts")));
}

TEST_F(HostileFile, ATissueWouldTakeMinutes) {
  const std::string of_16_cubed = copy_of("tissue-16-cubed-slow.toml");
  if (of_16_cubed.empty()) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  // By now those take seconds.
  std::string scene = test::content(of_16_cubed);
  const std::string cells = "cells = [16,16,16]";
  ASSERT_THAT(scene, HasSubstr(cells));
  const std::string file = beside("tissue-24-cubed.toml");
  test::write_file(file, scene.replace(scene.find(cells), cells.size(), "cells = [24,24,24]"));
  EXPECT_THAT([&] { (void)load_scene(file); },
              ThrowsMessage<SceneError>(
                  testing::AllOf(HasSubstr("its set-up would take about "), HasSubstr("expected at most 30 s"))));
}

}  // namespace
}  // namespace forcebound::server
