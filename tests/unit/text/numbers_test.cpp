#include "forcebound/text/numbers.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

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

TEST(WholeNumber, ReadsDigitsWithinTheTypesRange) {
  EXPECT_EQ(whole_number<std::uint64_t>("18446744073709551615"), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(whole_number<std::int64_t>("-1"), -1);
  for (const char* text : {"", " 1", "1 ", "1.0", "+1", "-1", "1e3", "0x1", "4294967296"}) {
    EXPECT_FALSE(whole_number<std::uint32_t>(text)) << "'" << text << "'";
  }
}

TEST(Rounded, ToThreeDigitsAsPeopleWriteThem) {
  EXPECT_EQ(rounded(0), "0");
  EXPECT_EQ(rounded(123456), "123000");
  EXPECT_EQ(rounded(50000), "50000");
  EXPECT_EQ(rounded(9999), "10000");
  EXPECT_EQ(rounded(0.0123456), "0.0123");
  EXPECT_EQ(rounded(-1.2345), "-1.23");
  EXPECT_EQ(rounded(1.5e-7), "1.5e-07");
  EXPECT_EQ(rounded(1e30), "1e+30");
  EXPECT_EQ(rounded(std::numeric_limits<double>::infinity()), "inf");
}

TEST(Fixed, HasSoManyDecimalsAndNoSignBeforeZero) {
  EXPECT_EQ(fixed(1.005, 1), "1.0");
  EXPECT_EQ(fixed(-0.0004, 3), "0.000");
  EXPECT_EQ(fixed(-0.0006, 3), "-0.001");
  EXPECT_EQ(fixed(1e300, 0).size(), 301U);
  EXPECT_EQ(fixed(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(fixed(-std::numeric_limits<double>::infinity(), 2), "-");
}

}  // namespace
}  // namespace forcebound::text
