#include "forcebound/client/rendering/scene_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "forcebound/client/rendering/local_rendering.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::client {
namespace {

using testing::HasSubstr;

handover::Hash hash(std::byte byte) {
  handover::Hash hash{};
  hash.fill(byte);
  return hash;
}

const std::vector<std::byte> kContent(1000, std::byte{5});

TEST(SceneCache, GivesBackWhatItWasGiven) {
  const test::TemporaryFolder folder;
  SceneCache cache(folder.file("new/folder"));
  EXPECT_EQ(cache.load(hash(std::byte{1})), std::nullopt);
  cache.store(hash(std::byte{1}), kContent);
  EXPECT_EQ(cache.load(hash(std::byte{1})), kContent);
  EXPECT_EQ(cache.load(hash(std::byte{2})), std::nullopt);
  EXPECT_EQ(cache.problem(), "");
}

TEST(SceneCache, KeepsNothingWithoutAFolder) {
  SceneCache cache("");
  cache.store(hash(std::byte{1}), kContent);
  EXPECT_EQ(cache.load(hash(std::byte{1})), std::nullopt);
  EXPECT_EQ(cache.problem(), "");
}

TEST(SceneCache, LetsTheOldestGoWhereItIsFull) {
  const test::TemporaryFolder folder;
  SceneCache cache(folder.file("cache"), 2500);
  for (int i = 1; i <= 3; ++i) {
    cache.store(hash(static_cast<std::byte>(i)), kContent);
    const std::string file = folder.file("cache/" + handover::to_text(hash(static_cast<std::byte>(i))) + ".scene");
    std::filesystem::last_write_time(file, std::filesystem::file_time_type(std::chrono::seconds(i)));
  }
  EXPECT_EQ(cache.load(hash(std::byte{1})), std::nullopt);
  EXPECT_EQ(cache.load(hash(std::byte{2})), kContent);
  EXPECT_EQ(cache.load(hash(std::byte{3})), kContent);
  cache.store(hash(std::byte{4}), std::vector<std::byte>(3000));
  EXPECT_EQ(cache.load(hash(std::byte{4})), std::nullopt) << "larger than all that it may keep";
}

TEST(SceneCache, LetsGoOfWhatAKilledProgramLeft) {
  const test::TemporaryFolder folder;
  SceneCache cache(folder.path().string(), 2500);
  const std::string left = folder.file(handover::to_text(hash(std::byte{9})) + ".scene.new-1");
  const std::vector<std::string> of_others{folder.file("notes.new-1"), folder.file("my.scene"), folder.file("a1.scene"),
                                           folder.file(std::string(64, 'a') + ".scenes")};
  const auto write = [](const std::string& file) {
    text::write_file(file, std::string(2000, 'x'));
    std::filesystem::last_write_time(file, std::filesystem::file_time_type(std::chrono::seconds(1)));
  };
  write(left);
  std::ranges::for_each(of_others, write);
  cache.store(hash(std::byte{1}), kContent);
  EXPECT_FALSE(std::filesystem::exists(left));
  for (const std::string& file : of_others) EXPECT_TRUE(std::filesystem::exists(file)) << file;
  EXPECT_EQ(cache.load(hash(std::byte{1})), kContent);
}

TEST(SceneCache, TellsInOneLineWhereItCannotWrite) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("file"), "not a folder");
  SceneCache cache(folder.file("file"));
  cache.store(hash(std::byte{1}), kContent);
  EXPECT_EQ(cache.load(hash(std::byte{1})), std::nullopt);
  EXPECT_THAT(cache.problem(), HasSubstr("cannot be written: "));
  EXPECT_EQ(cache.problem().find('\n'), std::string::npos);
}

TEST(SceneCache, TellsWhereAFileCannotBecomeThatLong) {
  const test::TemporaryFolder folder;
  SceneCache cache(folder.path().string());
  ::rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const ::rlimit few{.rlim_cur = 100, .rlim_max = before.rlim_max};
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &few), 0);
  cache.store(hash(std::byte{1}), kContent);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  (void)std::signal(SIGXFSZ, handler);
  EXPECT_THAT(cache.problem(), HasSubstr("cannot be written: "));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SceneCache, WritesThroughNoLinkAndForItsOwnerAlone) {
  const test::TemporaryFolder folder;
  const std::string of_another = folder.file("important");
  text::write_file(of_another, "important");
  SceneCache cache(folder.file("cache"));
  cache.store(hash(std::byte{1}), kContent);
  const std::string file = folder.file("cache/" + handover::to_text(hash(std::byte{1})) + ".scene");
  std::filesystem::remove(file);
  std::filesystem::create_symlink(of_another, file);
  std::filesystem::create_symlink(of_another, file + ".new-" + std::to_string(::getpid()));
  cache.store(hash(std::byte{1}), kContent);
  EXPECT_EQ(text::read_file(of_another), "important");
  EXPECT_FALSE(std::filesystem::is_symlink(file));
  EXPECT_EQ(cache.load(hash(std::byte{1})), kContent);
  EXPECT_EQ(std::filesystem::status(folder.file("cache")).permissions(), std::filesystem::perms::owner_all);
}

TEST(SceneCache, NeitherReadsNorWritesNorMakesRoomForAClientThatEnds) {
  const test::TemporaryFolder folder;
  SceneCache cache(folder.file("cache"), 2500);
  cache.store(hash(std::byte{1}), kContent);
  cache.store(hash(std::byte{2}), kContent);
  std::stop_source end;
  end.request_stop();
  EXPECT_EQ(cache.load(hash(std::byte{1}), end.get_token()), std::nullopt);
  cache.store(hash(std::byte{3}), kContent, end.get_token());
  EXPECT_EQ(cache.load(hash(std::byte{3})), std::nullopt);
  EXPECT_EQ(cache.load(hash(std::byte{1})), kContent);
  EXPECT_EQ(cache.load(hash(std::byte{2})), kContent);
  EXPECT_EQ(cache.problem(), "") << "nothing went wrong";
}

/// A builder with a cache, and the tick that it works for.
struct Visit {
  explicit Visit(const std::string& folder) : local({.degrees_of_freedom = 3, .cache_folder = folder}) {}

  void offer(const handover::PackedScene& scene) {
    const handover::Announcement& a = scene.announcement();
    local.begin(1, {.manifest_sha256 = a.hash,
                    .manifest_bytes = static_cast<std::uint32_t>(a.manifest_bytes),
                    .pieces = static_cast<std::uint32_t>(a.pieces)});
    local.builder().work();
  }
  void deliver(const handover::PackedScene& scene) {
    for (std::uint32_t i = 0; i < scene.announcement().pieces; ++i) {
      local.receive({.session = 1, .transmission = i + 1, .number = i, .content = scene.piece(i)});
      local.builder().work();
    }
  }
  LocalRendering local;
};

TEST(SceneCache, IsNotBelievedWhenAFileWasTamperedWithOrCut) {
  const test::TemporaryFolder folder;
  const auto scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 20)));
  Visit first(folder.path().string());
  first.offer(*scene);
  first.deliver(*scene);
  ASSERT_EQ(first.local.phase(), BuildPhase::whole);
  const std::string file = folder.file(handover::to_text(scene->announcement().hash) + ".scene");
  const std::string good = text::read_file(file);
  for (const std::size_t at : {std::size_t{5}, good.size() / 2, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    for (const std::string& content : {bad, good.substr(0, at), good + "x"}) {
      text::write_file(file, content);
      Visit again(folder.path().string());
      again.offer(*scene);
      EXPECT_EQ(again.local.phase(), BuildPhase::wanting) << at;
      EXPECT_THAT(again.local.builder().counts().cache_problem, HasSubstr("is not what the server announces"));
      again.deliver(*scene);
      EXPECT_EQ(again.local.phase(), BuildPhase::whole);
      EXPECT_EQ(text::read_file(file), good);
    }
  }
}

TEST(SceneCache, IsNotLookedIntoForAClientThatEnds) {
  const test::TemporaryFolder folder;
  const auto scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 20)));
  Visit first(folder.path().string());
  first.offer(*scene);
  first.deliver(*scene);
  ASSERT_EQ(first.local.phase(), BuildPhase::whole);
  const handover::Announcement& a = scene->announcement();
  Visit ends(folder.path().string());
  ends.local.begin(1, {.manifest_sha256 = a.hash,
                       .manifest_bytes = static_cast<std::uint32_t>(a.manifest_bytes),
                       .pieces = static_cast<std::uint32_t>(a.pieces)});
  std::stop_source end;
  end.request_stop();
  EXPECT_EQ(ends.local.builder().work(end.get_token()), 0U);
  EXPECT_EQ(ends.local.builder().counts().from_cache, 0U);
  EXPECT_EQ(ends.local.phase(), BuildPhase::looking);
  ends.local.builder().work();
  EXPECT_EQ(ends.local.builder().counts().from_cache, 1U) << "its order has waited";
}

TEST(SceneCache, KeepsAGoodFileWhateverSomebodyAnnounces) {
  const test::TemporaryFolder folder;
  const auto scene = handover::pack(*handover::mesh_scene(test::ball(0.03, 20)));
  Visit first(folder.path().string());
  first.offer(*scene);
  first.deliver(*scene);
  ASSERT_EQ(first.local.phase(), BuildPhase::whole);
  const handover::Announcement& a = scene->announcement();
  Visit lied_to(folder.path().string());
  lied_to.local.begin(1, {.manifest_sha256 = a.hash,
                          .manifest_bytes = static_cast<std::uint32_t>(a.manifest_bytes),
                          .pieces = static_cast<std::uint32_t>(a.pieces + 1)});
  lied_to.local.builder().work();
  EXPECT_NE(lied_to.local.phase(), BuildPhase::whole);
  Visit again(folder.path().string());
  again.offer(*scene);
  EXPECT_EQ(again.local.phase(), BuildPhase::whole);
}

}  // namespace
}  // namespace forcebound::client
