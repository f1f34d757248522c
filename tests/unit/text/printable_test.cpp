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

}  // namespace
}  // namespace forcebound::text
