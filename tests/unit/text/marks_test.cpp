#include "forcebound/text/marks.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace forcebound::text {
namespace {

constexpr Marks kBetween{.begin = "<!-- here -->\n", .end = "<!-- /here -->\n"};

TEST(Marks, GiveWhatIsBetweenThemAndKeepTheRest) {
  const std::string document = "before\n<!-- here -->\nold\n<!-- /here -->\nafter\n";
  EXPECT_EQ(between_marks(document, kBetween), "old\n");
  EXPECT_EQ(with_between_marks(document, kBetween, "new\nlines\n"),
            "before\n<!-- here -->\nnew\nlines\n<!-- /here -->\nafter\n");
}

TEST(Marks, AreNeededOnceEach) {
  const std::string begin(kBetween.begin);
  const std::string end(kBetween.end);
  const std::string twice = begin + end + begin + end;
  const std::string backwards = end + begin;
  for (const std::string& document : {std::string("nothing"), twice, backwards}) {
    EXPECT_THROW(static_cast<void>(between_marks(document, kBetween)), std::runtime_error) << document;
  }
}

}  // namespace
}  // namespace forcebound::text
