#include "forcebound/text/file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace forcebound::text {
namespace {

using testing::StrEq;
using testing::ThrowsMessage;

TEST(ReadFile, GivesEveryByte) {
  const auto path = std::filesystem::path(testing::TempDir()) / "read_file_test.txt";
  std::ofstream(path, std::ios::binary) << "one\r\n" << '\0' << "two";
  EXPECT_EQ(read_file(path.string()), std::string("one\r\n\0two", 9));
  std::ofstream(path, std::ios::trunc).close();
  EXPECT_EQ(read_file(path.string()), "");
  std::filesystem::remove(path);
}

TEST(ReadFile, SaysWhyAFileCannotBeRead) {
  EXPECT_THAT([] { (void)read_file("/nonexistent/file"); },
              ThrowsMessage<std::runtime_error>(StrEq("/nonexistent/file: cannot be read: No such file or directory")));
  EXPECT_THAT([] { (void)read_file("/"); },
              ThrowsMessage<std::runtime_error>(StrEq("/: cannot be read: it is a directory")));
}

TEST(WriteFile, PutsEveryByteInPlaceOfWhatWasThere) {
  const auto path = (std::filesystem::path(testing::TempDir()) / "write_file_test.txt").string();
  write_file(path, std::string("one\r\n\0two", 9));
  EXPECT_EQ(read_file(path), std::string("one\r\n\0two", 9));
  write_file(path, "1");
  EXPECT_EQ(read_file(path), "1");
  std::filesystem::remove(path);
}

// A test's own folder, to see what else lies in it.
class OutputFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
  }

 private:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "file_test_outputs";
};

TEST_F(OutputFolder, HoldsTheOldContentUntilTheNewOneIsWhole) {
  write_file(file("out"), "old");
  std::ifstream reader(file("out"));
  write_file(file("out"), "new");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "old") << "the open file was written over";
  EXPECT_EQ(read_file(file("out")), "new");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFolder, KeepsPermissionsAndLinks) {
  write_file(file("out"), "old");
  std::filesystem::permissions(file("out"), std::filesystem::perms::owner_all);
  std::filesystem::create_symlink("out", file("link"));
  write_file(file("link"), "by the link");
  EXPECT_TRUE(std::filesystem::is_symlink(file("link")));
  EXPECT_EQ(read_file(file("out")), "by the link");
  write_file(file("out"), "new");
  EXPECT_EQ(std::filesystem::status(file("out")).permissions(), std::filesystem::perms::owner_all);
  EXPECT_EQ(files(), 2);
}

TEST_F(OutputFolder, IsAsBeforeAfterAskingWhatCanBeWritten) {
  write_file(file("out"), "last results");
  EXPECT_NO_THROW(expect_writable(file("out")));
  EXPECT_NO_THROW(expect_writable(file("new")));
  EXPECT_NO_THROW(expect_writable("/dev/null"));
  EXPECT_EQ(read_file(file("out")), "last results");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFolder, IsNoFileToWrite) {
  EXPECT_THAT([&] { expect_writable(file("")); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("cannot be written: it is a directory")));
  EXPECT_THAT(
      [] { expect_writable("/nonexistent/file"); },
      ThrowsMessage<std::runtime_error>(StrEq("/nonexistent/file: cannot be written: No such file or directory")));
}

TEST(WriteFile, SaysWhyAFileCannotBeWritten) {
  EXPECT_THAT(
      [] { write_file("/nonexistent/file", "1"); },
      ThrowsMessage<std::runtime_error>(StrEq("/nonexistent/file: cannot be written: No such file or directory")));
  EXPECT_THAT([] { write_file("/dev/full", "1"); },
              ThrowsMessage<std::runtime_error>(StrEq("/dev/full: cannot be written: No space left on device")));
}

}  // namespace
}  // namespace forcebound::text
