// Scene files that were written for version 1 of the protocol.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "forcebound/scene/registry.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/environment/schema.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::server {
namespace {

using KeysByTable = std::map<std::string, std::set<std::string>>;

std::filesystem::path folder_of_version_1() { return test::source_folder() / "tests/support/version_1"; }

KeysByTable keys_of_version_1() {
  KeysByTable keys;
  std::istringstream lines(text::read_file((folder_of_version_1() / "scene_keys.txt").string()));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(": ");
    std::istringstream words(line.substr(colon + 2));
    for (std::string key; words >> key;) keys[line.substr(0, colon)].insert(key);
  }
  return keys;
}

/// The keys in the first column of each table of the page, by the heading above it.
KeysByTable keys_on(const std::string& page) {
  KeysByTable keys;
  std::istringstream lines(page);
  std::string heading;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) heading = line.substr(line.find(' ') + 1);
    if (line.starts_with("| `")) keys[heading].insert(line.substr(3, line.find('`', 3) - 3));
  }
  return keys;
}

TEST(SceneOfVersion1, LoadsAndHasThePartsThatTheSceneOfItsNameHasNow) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const SceneLibrary shipped = SceneLibrary::shipped();
  int scenes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_of_version_1() / "scenes")) {
    SCOPED_TRACE(file.path().string());
    const auto before = load_scene(file.path().string());
    const auto now = shipped.find(before->facts().name);
    ASSERT_NE(now, nullptr);
    EXPECT_EQ(before->facts().name, file.path().stem().string());
    EXPECT_EQ(before->facts().degrees_of_freedom, now->facts().degrees_of_freedom);
    EXPECT_EQ(before->facts().shared, now->facts().shared);
    EXPECT_EQ(before->objects().size(), now->objects().size());
    EXPECT_EQ(before->fields().size(), now->fields().size());
    EXPECT_EQ(before->dynamic_models().size(), now->dynamic_models().size());
    ++scenes;
  }
  EXPECT_EQ(scenes, 35);
}

TEST(SceneOfVersion1, HasNoKeyThatIsNotKnownNow) {
  KeysByTable before = keys_of_version_1();
  // Their keys are now told by the shapes; the next test has them.
  EXPECT_EQ(before.erase("`shape` of a `[[body]]`"), 1U);
  EXPECT_EQ(before.erase("`held` of a `[[tissue]]`"), 1U);
  ASSERT_EQ(before.size(), 39U);
  const KeysByTable now = keys_on(schema(scene::Registry::standard()));
  for (const auto& [table, keys] : before) {
    ASSERT_TRUE(now.contains(table)) << table;
    for (const std::string& key : keys) EXPECT_TRUE(now.at(table).contains(key)) << table << ": " << key;
  }
}

TEST(SceneOfVersion1, HasBodiesAndHeldTissueOfEveryKind) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  const auto bodies = parse_scene(
      "[scene]\nname = 'bodies'\ndescription = 'x'\ndegrees_of_freedom = 3\n"
      "[[body]]\nname = 'a'\nmass_kg = 0.1\nshape = { kind = 'box', center_m = [0, 0, 0], size_m = [0.1, 0.1, 0.1] }\n"
      "[[body]]\nname = 'b'\nmass_kg = 0.1\nshape = { kind = 'sphere', center_m = [0.3, 0, 0], radius_m = 0.1 }\n"
      "[[body]]\nname = 'c'\nmass_kg = 0.1\n"
      "shape = { kind = 'capsule', from_m = [0.6, 0, 0], to_m = [0.6, 0, 0.1], radius_m = 0.02 }\n"
      "[[body]]\nname = 'd'\nfixed = true\n"
      "shape = { kind = 'cylinder', from_m = [0.9, 0, 0], to_m = [0.9, 0, 0.1], radius_m = 0.02 }\n",
      "bodies.toml");
  EXPECT_EQ(bodies->dynamic_models().size(), 1U);
  for (const std::string held :
       {"through_m = [0, 0, -0.02], normal = [0, 0, 1]", "center_m = [0, 0, -0.02], size_m = [0.1, 0.1, 0.01]"}) {
    const auto tissue = parse_scene(
        "[scene]\nname = 'tissue'\ndescription = 'x'\ndegrees_of_freedom = 3\n"
        "[[tissue]]\nname = 'a'\nyoung_Pa = 10000\npoisson = 0.4\n"
        "shape = { kind = 'block', center_m = [0, 0, -0.01], size_m = [0.04, 0.04, 0.02], cells = [2, 2, 1] "
        "}\nheld = { " +
            held + " }\n",
        "tissue.toml");
    EXPECT_EQ(tissue->dynamic_models().size(), 1U) << held;
  }
}

}  // namespace
}  // namespace forcebound::server
