#include "forcebound/text/terminal.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace forcebound::text {
namespace {

TEST(Wrapped, LeavesShortLinesAsTheyAre) {
  EXPECT_EQ(wrapped("one\n\n  two\n", 4, 20), "one\n\n  two\n");
  EXPECT_EQ(wrapped("no end of line", 4, 20), "no end of line");
  EXPECT_EQ(wrapped("", 4, 20), "");
}

TEST(Wrapped, BreaksAtTheLastBlankThatFitsAndIndentsWhatFollows) {
  EXPECT_EQ(wrapped("a line of ten and more", 2, 10), "a line of\n  ten and\n  more");
  EXPECT_EQ(wrapped("exactly 10 and on\n", 0, 10), "exactly 10\nand on\n");
}

TEST(Wrapped, BreaksAWordThatIsTooLongAfterAComma) {
  EXPECT_EQ(wrapped("one,two,three,four", 2, 10), "one,two,\n  three,\n  four");
}

TEST(Wrapped, LeavesAWordWholeThatCannotBeBroken) {
  EXPECT_EQ(wrapped("/a/path/longer/than/the/line and more", 2, 10), "/a/path/longer/than/the/line\n  and more");
  EXPECT_EQ(wrapped(std::string(100, 'x'), 0, 10), std::string(100, 'x'));
}

TEST(Wrapped, CountsCharactersNotBytes) {
  EXPECT_EQ(columns_of("µm"), 2U);
  EXPECT_EQ(wrapped("µµµµ µµµµµ", 0, 10), "µµµµ µµµµµ");
}

TEST(Wrapped, DoesNotBreakBetweenANameAndItsWords) {
  EXPECT_EQ(wrapped("  operator    trace-sphere:mass_kg=0.1,stiffness", 14, 40),
            "  operator    trace-sphere:mass_kg=0.1,\n              stiffness");
  EXPECT_EQ(wrapped("  name        /a/path/longer/than/the/line", 14, 30),
            "  name        /a/path/longer/than/the/line");
}

TEST(WrappedBelowDescriptions, IndentsALineWithoutADescriptionByMore) {
  EXPECT_EQ(wrapped_below_descriptions("object 'ball': a sphere of any size\n", 2, 24),
            "object 'ball': a sphere\n  of any size\n");
  EXPECT_EQ(wrapped_below_descriptions("cost:   40 ns predicted", 2, 16), "cost:   40 ns\n        predicted");
}

TEST(WrappedHelp, GoesOnBelowTheDescription) {
  EXPECT_EQ(wrapped_help("  --law LAW   which of the laws it is\n", 24),
            "  --law LAW   which of\n              the laws\n              it is\n");
  EXPECT_EQ(wrapped_help("A sentence that is longer than it may be", 24), "A sentence that is\nlonger than it may be");
}

TEST(Colour, IsNotWantedOffATerminalNorWhereTheUserSaysSo) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_EQ(colour_for(ends[1]), Colour::none);
  close(ends[0]);
  close(ends[1]);
  EXPECT_EQ(red("-1 J", Colour::none), "-1 J");
  EXPECT_EQ(red("-1 J", Colour::ansi), "\033[31m-1 J\033[0m");
}

TEST(Colour, IsTakenAwayByNoColorOnATerminal) {
  const int terminal = posix_openpt(2 /* O_RDWR */);
  if (terminal < 0) GTEST_SKIP() << "no pseudo-terminal here";
  const auto with = [&](const char* no_color, const char* term) {
    no_color != nullptr ? setenv("NO_COLOR", no_color, 1) : unsetenv("NO_COLOR");
    setenv("TERM", term, 1);
    return colour_for(terminal);
  };
  EXPECT_EQ(with(nullptr, "xterm"), Colour::ansi);
  EXPECT_EQ(with("", "xterm"), Colour::ansi);
  EXPECT_EQ(with("1", "xterm"), Colour::none);
  EXPECT_EQ(with(nullptr, "dumb"), Colour::none);
  close(terminal);
}

TEST(Counted, HasASingular) {
  EXPECT_EQ(counted(0, "tick"), "0 ticks");
  EXPECT_EQ(counted(1, "tick"), "1 tick");
  EXPECT_EQ(counted(2, "tick"), "2 ticks");
  EXPECT_EQ(counted(2, "degree of freedom", "degrees of freedom"), "2 degrees of freedom");
}

}  // namespace
}  // namespace forcebound::text
