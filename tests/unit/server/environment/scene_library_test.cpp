#include "forcebound/server/environment/scene_library.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/text/names.hpp"
#include "tests/support/scene_files.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;

std::string library_error(const std::string& name_or_file) {
  try {
    (void)load_scene(name_or_file);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

TEST(SceneLibrary, ShipsEveryFileOfItsFolderInAlphabeticalOrder) {
  EXPECT_EQ(SceneLibrary::shipped().names(), text::join(test::scene_files()));
}

TEST(SceneLibrary, EverySceneIsNamedLikeItsFileAndDescribed) {
  if (!has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  for (const std::string& name : test::scene_files()) {
    const auto scene = load_scene((test::source_folder() / "server/scenes" / (name + ".toml")).string());
    EXPECT_EQ(scene->facts().name, name);
    EXPECT_TRUE(scene->facts().description.ends_with('.')) << name;
  }
}

TEST(SceneLibrary, ShowsEveryEffectThatFillsSpaceInASceneOfItsName) {
  const SceneLibrary library = SceneLibrary::shipped();
  const scene::Registry registry = scene::Registry::standard();
  for (const scene::EffectKind& kind : registry.effects()) {
    if (kind.place != scene::EffectPlace::space) continue;
    const auto scene = library.find(kind.name);
    ASSERT_NE(scene, nullptr) << kind.name;
    ASSERT_EQ(scene->fields().size(), 1U) << kind.name;
    EXPECT_EQ(scene->fields().front().effects.front().name, kind.name);
  }
}

TEST(SceneLibrary, ShipsTheScenesWithTheirDegreesOfFreedom) {
  const SceneLibrary library = SceneLibrary::shipped();
  const auto accepted = [&](std::string_view name) { return library.find(name)->accepted_degrees_of_freedom(); };
  EXPECT_EQ(accepted("wall"), "1 to 6");
  EXPECT_EQ(accepted("free"), "1 to 6");
  EXPECT_EQ(accepted("circle"), "2");
  EXPECT_EQ(accepted("sphere"), "3 or 6");
  EXPECT_EQ(accepted("plane"), "3 or 6");
  EXPECT_EQ(accepted("box"), "3 or 6");
}

TEST(Scene, AcceptsTheDegreesOfFreedomThatItLists) {
  const SceneLibrary library = SceneLibrary::shipped();
  const auto accepted = [&](std::string_view name) {
    std::string numbers;
    for (std::uint32_t dof = 0; dof < 9; ++dof) {
      if (library.find(name)->accepts(dof)) numbers += std::to_string(dof);
    }
    return numbers;
  };
  EXPECT_EQ(accepted("wall"), "123456");
  EXPECT_EQ(accepted("circle"), "2");
  EXPECT_EQ(accepted("sphere"), "36");
}

TEST(SceneLibrary, TheOwnersSceneReplacesAShippedOne) {
  SceneLibrary library = SceneLibrary::shipped();
  const auto own = parse_scene("[scene]\nname = 'wall'\ndescription = 'no wall'\ndegrees_of_freedom = 1\n", "own.toml");
  library.add(own);
  EXPECT_EQ(library.find("wall"), own);
  EXPECT_EQ(library.names(), SceneLibrary::shipped().names());
}

/// It would never return if the one scene waited for the other's compilation.
TEST(SceneLibrary, FindsWhatACopyHasCompiledWhileAnotherIsBeingCompiled) {
  SceneLibrary library;
  std::shared_ptr<const scene::Scene> found;
  const auto measure = [&](const std::shared_ptr<const scene::Scene>&) {
    if (!found) found = library.find("sphere");
    return 1e-6;
  };
  library = SceneLibrary::shipped(scene::Registry::standard(), measure);
  const SceneLibrary copy = library;
  const auto sphere = copy.find("sphere");
  ASSERT_NE(copy.find("soft_pad"), nullptr) << "each of whose levels is measured";
  EXPECT_EQ(found, sphere);
}

TEST(SceneLibrary, DoesNotLookAtFilesForAClient) { EXPECT_EQ(SceneLibrary::shipped().find("/etc/passwd"), nullptr); }

TEST(LoadScene, UnknownNameListsTheKnownOnes) {
  EXPECT_THAT(library_error("\x1b[2J"), testing::StartsWith("no scene '?[2J'"));
  EXPECT_EQ(library_error("spere"), "no scene 'spere', did you mean 'sphere'? (known: " +
                                        SceneLibrary::shipped().names() + "); a file is given as FILE.toml");
}

TEST(LoadScene, ReadsAFile) {
  const std::string path = testing::TempDir() + "scene_library_test.toml";
  std::ofstream(path) << "[scene]\nname = 'mine'\ndescription = ''\ndegrees_of_freedom = 2\n";
  EXPECT_EQ(load_scene(path)->facts().name, "mine");
}

TEST(LoadScene, NamesTheFileThatIsNotThere) {
  EXPECT_EQ(library_error("/nowhere/x.toml"), "/nowhere/x.toml: cannot be read: No such file or directory");
}

TEST(LoadScene, RefusesAFolder) {
  EXPECT_THAT(library_error("/tmp/"), HasSubstr("/tmp/: cannot be read: it is a directory"));
}

}  // namespace
}  // namespace forcebound::server
