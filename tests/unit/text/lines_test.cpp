#include "forcebound/text/lines.hpp"

#include <gmock/gmock.h>

#include <sstream>

namespace forcebound::text {
namespace {

using testing::ElementsAre;
using testing::StrEq;
using testing::ThrowsMessage;

TEST(Split, TakesTheBlanksFromAroundEachField) {
  EXPECT_THAT(split(" a b ,c\t,,d\r", ','), ElementsAre("a b", "c", "", "d"));
  EXPECT_THAT(split("", ','), ElementsAre(""));
}

TEST(SplitAtBlanks, GivesTheWordsBetweenBlanksOfAnyKind) {
  EXPECT_THAT(split_at_blanks(" one\t two\r\n\fthree\v4"), ElementsAre("one", "two", "three", "4"));
  EXPECT_THAT(split_at_blanks("one "), ElementsAre("one"));
  EXPECT_THAT(split_at_blanks(""), ElementsAre());
  EXPECT_THAT(split_at_blanks(" \n"), ElementsAre());
}

TEST(LineReader, ReadsWhatAnyEditorWrites) {
  std::istringstream text(
      "\xEF\xBB\xBF"
      "one\r\n\n  two\nthree");
  LineReader lines(text, "t.csv");
  std::vector<std::string> read;
  while (lines.next()) read.emplace_back(lines.line());
  EXPECT_THAT(read, ElementsAre("one", "", "two", "three"));
}

TEST(LineReader, NamesFileAndLineOfWhatIsWrong) {
  std::istringstream text("one\ntwo\n");
  LineReader lines(text, "t.csv");
  ASSERT_TRUE(lines.next());
  ASSERT_TRUE(lines.next());
  EXPECT_THAT([&] { lines.refuse("is wrong"); }, ThrowsMessage<std::runtime_error>(StrEq("t.csv:2: is wrong")));
}

TEST(LineReader, BlamesTheFirstLineOfAnEmptyFile) {
  std::istringstream text;
  LineReader lines(text, "t.csv");
  EXPECT_FALSE(lines.next());
  EXPECT_THAT([&] { lines.refuse("is empty"); }, ThrowsMessage<std::runtime_error>(StrEq("t.csv:1: is empty")));
}

}  // namespace
}  // namespace forcebound::text
