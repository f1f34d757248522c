#include "forcebound/results/outputs.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::results {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr text::Marks kTestMarks{"<!-- here -->\n", "<!-- /here -->\n"};

TEST(Outputs, ThatCanBeWrittenStayAsTheyAreUntilThen) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("a.json"), "last results");
  text::write_file(folder.file("page.md"), "<!-- here -->\nold\n<!-- /here -->\n");
  prepare({.inputs = {"", folder.file("in.mcap")},
           .files = {"", folder.file("a.json"), folder.file("new.csv")},
           .page = folder.file("page.md"),
           .marks = kTestMarks,
           .folder = folder.file("figures/of/today"),
           .figures = pictures_in(folder.file("figures/of/today"), {"one.png", "two.png"})});
  EXPECT_EQ(text::read_file(folder.file("a.json")), "last results");
  EXPECT_THAT(text::read_file(folder.file("page.md")), HasSubstr("old"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("new.csv")));
  EXPECT_TRUE(std::filesystem::is_empty(folder.file("figures/of/today")));
  EXPECT_NO_THROW(prepare({}));
}

TEST(Outputs, ThatCannotBeWrittenAreRefusedByName) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("file"), "");
  text::write_file(folder.file("page.md"), "no marks");
  const auto refused = [](const Outputs& outputs, const std::string& file, const std::string& why) {
    EXPECT_THAT([&] { prepare(outputs); }, ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(file), HasSubstr(why))));
  };
  refused({.files = {folder.file("no/a.json")}}, folder.file("no/a.json"), "No such file or directory");
  refused({.files = {folder.path().string()}}, folder.path().string(), "it is a directory");
  refused({.figures = {folder.file("no/a.png")}}, folder.file("no/a.png"), "No such file or directory");
  refused({.folder = folder.file("file")}, folder.file("file"), "cannot create the directory");
  refused({.page = folder.file("no.md"), .marks = kTestMarks}, folder.file("no.md"), "cannot be read");
  refused({.page = folder.file("page.md"), .marks = kTestMarks}, folder.file("page.md"), "<!-- here -->");
}

TEST(Outputs, ThatAreRefusedLeaveNoFolder) {
  const test::TemporaryFolder folder;
  const std::string figures = folder.file("figures/of/today");
  EXPECT_THROW(prepare({.files = {folder.file("no/a.json")}, .folder = figures}), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_NO_THROW(prepare({.files = {figures + "/a.json"}, .folder = figures})) << "a file in the new folder";
  EXPECT_TRUE(std::filesystem::exists(figures));
}

// A path through a file is none: it is neither there nor an error of the check itself.
TEST(Outputs, BelowAFileAreRefusedByName) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("file"), "");
  EXPECT_THAT([&] { prepare({.inputs = {folder.file("file/in")}, .files = {folder.file("file/a.json")}}); },
              ThrowsMessage<std::runtime_error>(HasSubstr(folder.file("file/a.json") + ": cannot be written: ")));
  const std::string too_long = folder.file(std::string(300, 'n'));
  EXPECT_THAT([&] { prepare({.files = {too_long}}); },
              ThrowsMessage<std::runtime_error>(HasSubstr(too_long + ": cannot be written: File name too long")));
}

TEST(Outputs, ReplaceNeitherEachOtherNorAnInput) {
  const test::TemporaryFolder folder;
  const std::string recording = folder.file("run.mcap");
  text::write_file(recording, "");
  const auto refused = [](const Outputs& outputs, const std::string& why) {
    EXPECT_THAT([&] { prepare(outputs); }, ThrowsMessage<std::invalid_argument>(HasSubstr(why)));
  };
  refused({.inputs = {recording}, .files = {folder.file("./run.mcap")}}, "would be replaced, but is read");
  refused({.files = {folder.file("a"), folder.file("b"), folder.file("./a")}}, "would be written twice");
  refused({.files = {folder.file("a.csv")}, .figures = {folder.file("a.png")}},
          "would replace " + folder.file("a.csv"));
  std::filesystem::create_hard_link(recording, folder.file("other name"));
  refused({.inputs = {recording}, .files = {folder.file("other name")}}, "would be replaced, but is read");
  refused({.inputs = {recording, folder.file("a.gnuplot")}, .figures = {folder.file("a.png")}}, "a.gnuplot");
  // A scene's name is no file, and a device takes everything.
  EXPECT_NO_THROW(prepare({.inputs = {folder.file("wall")}, .files = {folder.file("wall"), "/dev/null", "/dev/null"}}));
}

}  // namespace
}  // namespace forcebound::results
