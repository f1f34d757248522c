#include "forcebound/page/assets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "forcebound/page/listen_address.hpp"
#include "forcebound/text/file.hpp"

namespace forcebound::page {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class AssetsTest : public testing::Test {
 protected:
  AssetsTest() : folder(fs::temp_directory_path() / ("forcebound-assets-" + std::to_string(::getpid()))) {
    fs::create_directories(folder / "licences");
  }
  ~AssetsTest() override { fs::remove_all(folder); }

  fs::path folder;
};

TEST_F(AssetsTest, AreTheFilesOfKnownTypesOfAFolder) {
  text::write_file((folder / "index.html").string(), "<p>");
  text::write_file((folder / "licences" / "a.txt").string(), "free");
  text::write_file((folder / "secret.key").string(), "key");
  fs::create_symlink("/etc/passwd", folder / "passwd.txt");
  const Assets assets = read_assets(folder);
  ASSERT_EQ(assets.size(), 2);
  EXPECT_EQ(assets.at("index.html").content, "<p>");
  EXPECT_EQ(assets.at("licences/a.txt").type, "text/plain; charset=utf-8");
}

TEST_F(AssetsTest, OfAFolderThatIsMissingAreNone) { EXPECT_TRUE(read_assets(folder / "nothing").empty()); }

TEST_F(AssetsTest, AreRefusedIfTooMany) {
  for (std::size_t i = 0; i <= kAssetsMost; ++i) {
    text::write_file((folder / (std::to_string(i) + ".js")).string(), "");
  }
  EXPECT_THROW((void)read_assets(folder), std::runtime_error);
}

TEST_F(AssetsTest, OfAMissingPageAreOneLineThatSaysHowToGetIt) {
  const std::string program = (folder / "bin" / "forcebound-client").string();
  const std::string why = missing_page(program);
  EXPECT_THAT(why, HasSubstr("run deploy/setup, then configure and build again"));
  EXPECT_EQ(page_settings({}, program).assets.at("index.html").content, why + "\n");
  const fs::path page = page_folder(program);
  fs::create_directories(page);
  text::write_file((page / "index.html").string(), "<p>");
  EXPECT_EQ(missing_page(program), "");
  EXPECT_EQ(page_settings({}, program).assets.at("index.html").content, "<p>");
}

TEST(PageFolder, IsBesideTheProgramsFolder) {
  EXPECT_EQ(page_folder("/usr/bin/forcebound-client"), "/usr/share/forcebound/page");
}

TEST(ListenAddress, IsOfThisMachineUnlessAHostIsGiven) {
  EXPECT_EQ(parse_listen_address("", 47880).port, 47880);
  EXPECT_EQ(parse_listen_address("5000", 47880).host, "127.0.0.1");
  EXPECT_EQ(parse_listen_address("5000", 47880).port, 5000);
  EXPECT_EQ(parse_listen_address("0.0.0.0:0", 47880).host, "0.0.0.0");
  EXPECT_EQ(parse_listen_address("[::1]:5000", 47880).host, "[::1]");
  for (const char* const wrong : {":5000", "host", "host:", "70000", "-1", "127.0.0.1:http"}) {
    try {
      (void)parse_listen_address(wrong, 47880);
      ADD_FAILURE() << wrong;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(wrong));
    }
  }
}

TEST(PageSettings, HaveATokenOf128BitsThatIsNewEachTime) {
  const std::string one = page_settings({}, "/nowhere/bin/program").token;
  const std::string other = page_settings({}, "/nowhere/bin/program").token;
  EXPECT_EQ(one.size(), 32);
  EXPECT_NE(one, other);
}

}  // namespace
}  // namespace forcebound::page
