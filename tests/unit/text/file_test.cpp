#include "forcebound/text/file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

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

TEST(WriteFile, SaysWhyAFileCannotBeWritten) {
  EXPECT_THAT(
      [] { write_file("/nonexistent/file", "1"); },
      ThrowsMessage<std::runtime_error>(StrEq("/nonexistent/file: cannot be written: No such file or directory")));
  EXPECT_THAT([] { write_file("/dev/full", "1"); },
              ThrowsMessage<std::runtime_error>(StrEq("/dev/full: cannot be written: No space left on device")));
}

}  // namespace
}  // namespace forcebound::text
