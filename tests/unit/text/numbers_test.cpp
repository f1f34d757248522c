#include "forcebound/text/numbers.hpp"

#include <gtest/gtest.h>

namespace forcebound::text {
namespace {

TEST(ToText, NumbersReadBackAsThemselves) {
  EXPECT_EQ(to_text(50000), "50000");
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(-1e-300), "-1e-300");
}

TEST(FiniteNumber, ReadsAnyNotation) {
  EXPECT_EQ(finite_number("50000"), 50000);
  EXPECT_EQ(finite_number("-1.5e-3"), -1.5e-3);
}

TEST(FiniteNumber, RefusesWhatIsNotWhollyOneFiniteNumber) {
  for (const char* text : {"", " ", "1,5", "1 ", "two", "inf", "nan", "1e999"}) {
    EXPECT_FALSE(finite_number(text)) << "'" << text << "'";
  }
}

}  // namespace
}  // namespace forcebound::text
