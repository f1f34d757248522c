#include "forcebound/text/split.hpp"

#include <gmock/gmock.h>

namespace forcebound::text {
namespace {

using testing::ElementsAre;

TEST(Split, LooksForSeparatorsOutsideOfQuotesAndBrackets) {
  EXPECT_THAT(split_outside_brackets("a.b", '.'), ElementsAre("a", "b"));
  EXPECT_THAT(split_outside_brackets("[4, 4],{ b = 1, c = 2 },'x,y',\"]\",1", ','),
              ElementsAre("[4, 4]", "{ b = 1, c = 2 }", "'x,y'", "\"]\"", "1"));
}

TEST(Split, GivesAPartMoreThanThereAreSeparators) {
  EXPECT_THAT(split_outside_brackets("", ','), ElementsAre(""));
  EXPECT_THAT(split_outside_brackets("a,", ','), ElementsAre("a", ""));
}

}  // namespace
}  // namespace forcebound::text
