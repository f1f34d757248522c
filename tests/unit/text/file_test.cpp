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

}  // namespace
}  // namespace forcebound::text
