#include "forcebound/client/commands/replay/csv_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace forcebound::client::commands {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StrEq;
using testing::ThrowsMessage;

const std::vector<std::string> kColumns{"a", "b"};

TEST(CsvReader, ReadsNamesAndNumbers) {
  std::istringstream text("a,b\n1,-2.5e-3\n");
  CsvReader reader(text, "t.csv");
  EXPECT_THAT(reader.header(), ElementsAre("a", "b"));
  EXPECT_THAT(reader.row(kColumns), ElementsAre(1.0, -2.5e-3));
  EXPECT_THAT(reader.row(kColumns), IsEmpty());
}

TEST(CsvReader, AcceptsWhatOtherProgramsWrite) {
  std::istringstream text(
      "\xEF\xBB\xBF"
      "a, b\r\n 1 ,\t2\r\n+3,4E2\r\n\r\n  \r\n");
  CsvReader reader(text, "t.csv");
  EXPECT_THAT(reader.header(), ElementsAre("a", "b"));
  EXPECT_THAT(reader.row(kColumns), ElementsAre(1.0, 2.0));
  EXPECT_THAT(reader.row(kColumns), ElementsAre(3.0, 400.0));
  EXPECT_THAT(reader.row(kColumns), IsEmpty());
}

TEST(CsvReader, ReadsALastLineWithoutItsEnd) {
  std::istringstream text("a,b\n1,2");
  CsvReader reader(text, "t.csv");
  (void)reader.header();
  EXPECT_THAT(reader.row(kColumns), ElementsAre(1.0, 2.0));
}

TEST(CsvReader, NamesFileAndLineOfWhatItRefuses) {
  std::istringstream text("a,b\n1,2\n1,2,3\n1,x\n1,\n\n1,2\n");
  CsvReader reader(text, "t.csv");
  (void)reader.header();
  (void)reader.row(kColumns);
  const auto next = [&] { (void)reader.row(kColumns); };
  EXPECT_THAT(next, ThrowsMessage<std::runtime_error>(StrEq("t.csv:3: expected 2 numbers, got 3")));
  EXPECT_THAT(next, ThrowsMessage<std::runtime_error>(StrEq(
                        "t.csv:4: b: 'x' is not a number; a number such as 0.25 or -1e-3, nan or inf was expected")));
  EXPECT_THAT(next, ThrowsMessage<std::runtime_error>(testing::HasSubstr("t.csv:5: b: '' is not a number")));
  EXPECT_THAT(next, ThrowsMessage<std::runtime_error>(testing::HasSubstr("t.csv:7: a row after a blank line")));
}

TEST(CsvReader, RefusesAnEmptyFile) {
  std::istringstream text;
  EXPECT_THAT([&] { (void)CsvReader(text, "t.csv").header(); },
              ThrowsMessage<std::runtime_error>(testing::HasSubstr("t.csv:1: the file is empty")));
}

TEST(ParseNumber, ReadsEveryNotationOfANumber) {
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
  EXPECT_EQ(parse_number("-1E+3"), -1e3);
  EXPECT_EQ(parse_number(".5"), 0.5);
  EXPECT_EQ(parse_number("5e-324"), 5e-324);
  EXPECT_EQ(parse_number("0.1000000000000000055511151231257827"), 0.1);
  EXPECT_TRUE(std::isnan(parse_number("nan")));
  EXPECT_EQ(parse_number("-inf"), -HUGE_VAL);
}

TEST(ParseNumber, RefusesWhatIsOnlyNearlyOne) {
  for (const char* text : {"", " ", "1 2", "1,5", "0x10", "1e", "--1", "+-1", "1m", "one"}) {
    EXPECT_THROW((void)parse_number(text), std::invalid_argument) << text;
  }
  EXPECT_THAT([] { (void)parse_number("1e400"); },
              ThrowsMessage<std::invalid_argument>(StrEq("'1e400' is beyond a double")));
  EXPECT_THAT([] { (void)parse_number(std::string("1\0", 2)); },
              ThrowsMessage<std::invalid_argument>(StrEq("'1?' is not a number")));
}

}  // namespace
}  // namespace forcebound::client::commands
