#include "forcebound/text/printable.hpp"

#include <gtest/gtest.h>

namespace forcebound::text {
namespace {

TEST(Printable, LeavesWordsOfEveryLanguageAlone) {
  for (const char* text : {"", "ball (sphere): 10 N/mm", "Kugel 20 \xc2\xb5m", "\xe2\x82\xac \xc3\xa9 \xc4\x80"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, DisarmsEscapeSequencesAndLineEndings) {
  EXPECT_EQ(printable("\x1b]0;owned\x07\x1b[2J"), "?]0;owned??[2J");
  EXPECT_EQ(printable("a\r\nfake: line\t\x7f"), "a??fake: line??");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
}

TEST(Printable, DisarmsControlCharactersBeyondAscii) {
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "??2J");
  EXPECT_EQ(printable("cut \xc2"), "cut \xc2") << "no control character without its second byte";
}

TEST(Printable, DisarmsControlCharactersOfEightBits) {
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "?2J");
  EXPECT_EQ(printable("\xc3\x9b \xe2\x82\x9b"), "\xc3\x9b \xe2\x82\x9b") << "there it is part of a character";
  EXPECT_EQ(printable("\xc3\x9b\x9b"), "\xc3\x9b?") << "behind a character that is complete";
}

TEST(Printable, KeepsTheLineFeedsOfLines) {
  EXPECT_EQ(printable_lines("one\ntwo \x1b[2J\n\nthree\r"), "one\ntwo ?[2J\n\nthree?");
  EXPECT_EQ(printable_lines(""), "");
  EXPECT_EQ(printable_lines("\n"), "\n");
  EXPECT_EQ(printable_lines("cut \xc2\n\x9b"), "cut \xc2\n?");
}

}  // namespace
}  // namespace forcebound::text
