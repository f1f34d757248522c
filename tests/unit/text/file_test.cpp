#include "forcebound/text/file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/tools/temporary_folder.hpp"

namespace forcebound::text {
namespace {

using testing::StartsWith;
using testing::StrEq;
using testing::ThrowsMessage;

TEST(ReadFile, GivesEveryByte) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "text";
  std::ofstream(path, std::ios::binary) << "one\r\n" << '\0' << "two";
  EXPECT_EQ(read_file(path.string()), std::string("one\r\n\0two", 9));
  std::ofstream(path, std::ios::trunc).close();
  EXPECT_EQ(read_file(path.string()), "");
}

TEST(ReadFile, SaysWhyAFileCannotBeRead) {
  EXPECT_THAT([] { (void)read_file("/nonexistent/file"); },
              ThrowsMessage<std::runtime_error>(StrEq("/nonexistent/file: cannot be read: No such file or directory")));
  EXPECT_THAT([] { (void)read_file("/"); },
              ThrowsMessage<std::runtime_error>(StrEq("/: cannot be read: it is a directory")));
  EXPECT_THAT([] { (void)read_file("/nonexistent/\x1b[2J"); },
              ThrowsMessage<std::runtime_error>(StartsWith("/nonexistent/?[2J: cannot be read")));
}

TEST(ReadFile, TakesRegularFilesOnly) {
  const test::TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  // None of them is waited for: nobody writes to the pipe.
  for (const std::string& file : {std::string("/dev/zero"), std::string("/dev/null"), pipe}) {
    EXPECT_THAT([&] { (void)read_file(file); },
                ThrowsMessage<std::runtime_error>(StrEq(file + ": cannot be read: it is no regular file")));
  }
  write_file(folder.file("text"), "text");
  std::filesystem::create_symlink("text", folder.file("link"));
  EXPECT_EQ(read_file(folder.file("link")), "text");
}

TEST(ReadFile, TakesFilesUpToASize) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("text");
  write_file(file, "12345");
  EXPECT_EQ(read_file(file, 5), "12345");
  EXPECT_THAT([&] { (void)read_file(file, 4); },
              ThrowsMessage<std::runtime_error>(
                  StrEq(file + ": cannot be read: it has more than 4 bytes, expected at most that")));
  // It takes no room on the disk, and none in memory.
  std::filesystem::resize_file(file, kFileBytesMost + 1);
  EXPECT_THAT([&] { (void)read_file(file); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("it has more than 268435456 bytes")));
}

// The size of such a file is said to be 0.
TEST(ReadFile, ReadsToTheEndWhateverTheSizeSays) {
  EXPECT_NE(read_file("/proc/self/status"), "");
  EXPECT_THAT([] { (void)read_file("/proc/self/status", 10); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("more than 10 bytes")));
}

// The process has nothing at address 0.
TEST(ReadFile, SaysWhyReadingFails) {
  EXPECT_THAT([] { (void)read_file("/proc/self/mem"); },
              ThrowsMessage<std::runtime_error>(StrEq("/proc/self/mem: cannot be read: Input/output error")));
}

// A folder `in` with a file, and another `out` beside it.
class FileThatAnotherNames : public testing::Test {
 protected:
  FileThatAnotherNames() {
    for (const char* folder : {"in", "out"}) {
      std::filesystem::create_directory(folder_.file(folder));
      write_file(folder_.file(std::string(folder) + "/a.obj"), "");
    }
  }

  [[nodiscard]] std::string of(const std::string& name) const { return folder_.file(name); }

  void expect_refused(const std::string& named) const {
    EXPECT_THAT([&] { (void)path_within(named, of("in")); },
                ThrowsMessage<std::runtime_error>(testing::AllOf(
                    testing::HasSubstr("lies outside of '" + of("in") + "'"), testing::HasSubstr("a.obj"))));
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(FileThatAnotherNames, LiesInItsFolder) {
  EXPECT_EQ(path_within("a.obj", of("in")), of("in/a.obj"));
  EXPECT_EQ(path_within("a.obj", of("in/")), of("in/a.obj"));
  EXPECT_EQ(path_within("deeper/gone.obj", of("in")), of("in/deeper/gone.obj")) << "there or not";
  EXPECT_EQ(path_within(of("in/a.obj"), of("in")), of("in/a.obj"));
  EXPECT_EQ(path_within("../in/a.obj", of("in")), of("in/../in/a.obj"));
  EXPECT_EQ(path_within("a.obj", ""), "a.obj");
}

TEST_F(FileThatAnotherNames, LiesNowhereElse) {
  expect_refused("../out/a.obj");
  expect_refused(of("out/a.obj"));
  expect_refused("deeper/../../out/a.obj");
  std::filesystem::create_symlink(of("out/a.obj"), of("in/link.obj"));
  EXPECT_THROW((void)path_within("link.obj", of("in")), std::runtime_error) << "by a link";
  std::filesystem::create_directory_symlink(of("out"), of("in/linked"));
  expect_refused("linked/a.obj");
  std::filesystem::create_directory(of("in_too"));
  EXPECT_THROW((void)path_within("../in_too/a.obj", of("in")), std::runtime_error) << "begins alike";
  EXPECT_THROW((void)path_within("/etc/shadow", ""), std::runtime_error);
  EXPECT_THROW((void)path_within("", of("in")), std::runtime_error) << "the folder itself";
  const std::string zero("../out/a.obj\0/../../in/a.obj", 28);
  EXPECT_THAT([&] { (void)path_within(zero, of("in")); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("its name has a zero byte")));
}

TEST_F(FileThatAnotherNames, MayLieInAFolderThatIsAllowed) {
  const std::array allowed{of("elsewhere"), of("out")};
  EXPECT_EQ(path_within(of("out/a.obj"), of("in"), allowed), of("out/a.obj"));
  EXPECT_THAT([&] { (void)path_within("/etc/shadow", of("in"), allowed); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("' or '" + of("out") + "'")));
}

TEST(WriteFile, PutsEveryByteInPlaceOfWhatWasThere) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("text");
  write_file(path, std::string("one\r\n\0two", 9));
  EXPECT_EQ(read_file(path), std::string("one\r\n\0two", 9));
  write_file(path, "1");
  EXPECT_EQ(read_file(path), "1");
}

// A test's own folder, to see what else lies in it.
class OutputFolder : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_.path()), std::filesystem::directory_iterator());
  }

 private:
  test::TemporaryFolder folder_;
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

// Files that the process writes can have at most so many bytes, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const ::rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    (void)std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  void (*handler_)(int);
  ::rlimit before_{};
};

TEST_F(OutputFolder, HoldsTheOldContentAloneIfTheNewOneDoesNotFit) {
  constexpr std::size_t kBytes = 4096;
  write_file(file("out"), "old");
  const auto write_too_much = [&] {
    const FileSizeLimit limit(kBytes);
    write_file(file("out"), std::string(2 * kBytes, 'n'));
  };
  EXPECT_THAT(write_too_much,
              ThrowsMessage<std::runtime_error>(StrEq(file("out") + ": cannot be written: File too large")));
  EXPECT_EQ(read_file(file("out")), "old");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFolder, TakesNamesTooLongForTheEndingOfANewFile) {
  const std::string name(255, 'n');
  EXPECT_NO_THROW(expect_writable(file(name)));
  EXPECT_EQ(files(), 0);
  write_file(file(name), "first");
  write_file(file(name), "second");
  EXPECT_EQ(read_file(file(name)), "second");
  EXPECT_EQ(files(), 1);
}

TEST_F(OutputFolder, KeepsFilesOfSeveralNamesTogether) {
  write_file(file("out"), "old");
  std::filesystem::create_hard_link(file("out"), file("other"));
  write_file(file("out"), "new");
  EXPECT_EQ(read_file(file("other")), "new");
  EXPECT_EQ(files(), 2);
}

TEST_F(OutputFolder, MayHoldLinksToFilesThatAreNotThereYet) {
  std::filesystem::create_symlink("middle", file("link"));
  std::filesystem::create_symlink("target", file("middle"));
  EXPECT_NO_THROW(expect_writable(file("link")));
  EXPECT_EQ(files(), 2) << "the target was left behind";
  write_file(file("link"), "by the links");
  EXPECT_EQ(read_file(file("target")), "by the links");
  EXPECT_TRUE(std::filesystem::is_symlink(file("link")));

  std::filesystem::create_symlink("circle", file("circle"));
  EXPECT_THAT([&] { expect_writable(file("circle")); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("Too many levels of symbolic links")));
  std::filesystem::create_symlink("/nonexistent/file", file("nowhere"));
  EXPECT_THAT([&] { expect_writable(file("nowhere")); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("No such file or directory")));
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

TEST_F(OutputFolder, KnowsFilesByAllTheirNames) {
  write_file(file("out"), "");
  std::filesystem::create_hard_link(file("out"), file("other"));
  std::filesystem::create_symlink("new", file("link"));
  EXPECT_TRUE(is_same_path(file("out"), file("./out")));
  EXPECT_TRUE(is_same_path(file("out"), file("other")));
  EXPECT_TRUE(is_same_path(file("link"), file("new"))) << "which is not there yet";
  EXPECT_TRUE(is_same_path(file("none/../new"), file("new")));
  EXPECT_FALSE(is_same_path(file("out"), file("new")));
  EXPECT_FALSE(is_same_path("", file("new")));
}

TEST_F(OutputFolder, MayHoldSpecialFiles) {
  write_file(file("out"), "");
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("pipe", file("link"));
  EXPECT_TRUE(is_special_file("/dev/null"));
  EXPECT_TRUE(is_special_file(file("link")));
  EXPECT_FALSE(is_special_file(file("out")));
  EXPECT_FALSE(is_special_file(file("none")));
  EXPECT_FALSE(is_special_file(""));
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
