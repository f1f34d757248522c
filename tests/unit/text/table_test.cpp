#include "forcebound/text/table.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

namespace forcebound::text {
namespace {

Table sample_table() {
  Table table({{"law"}, {"least P", "J"}, {"remark", "", Table::Align::left}});
  table.add({"none", {"-0.651", Table::Mark::alarm}, "gives energy away, \"much\" | more"});
  table.add({"fba-exact", {"0", Table::Mark::best}, ""});
  table.add_remark("wave", "refuses: the device has no damping");
  return table;
}

TEST(Table, AlignsNamesLeftAndNumbersRight) {
  EXPECT_EQ(sample_table().to_text(),
            "  law        least P  remark\n"
            "                 [J]\n"
            "  none        -0.651  gives energy away, \"much\" | more\n"
            "  fba-exact        0\n"
            "  wave       refuses: the device has no damping\n");
}

TEST(Table, ShowsAlarmsInRedWithoutMovingWhatFollows) {
  EXPECT_THAT(sample_table().to_text(Colour::ansi), testing::HasSubstr("  none       \033[31m -0.651\033[0m  gives"));
}

TEST(Table, ContinuesBelowWhereItIsTooWide) {
  Table table({{"law"}, {"first"}, {"second"}, {"third"}});
  table.add({"none", "1", "2", "3"});
  EXPECT_EQ(table.to_text(Colour::none, 21),
            "  law   first  second\n"
            "  none      1       2\n"
            "  law   third\n"
            "  none      3\n");
}

TEST(Table, CountsCharactersAndNotBytes) {
  Table table({{"name"}, {"µ"}});
  table.add({"é", "1"});
  EXPECT_EQ(table.to_text(), "  name  µ\n  é     1\n");
}

TEST(Table, IsMarkdownWithUnitsInTheHead) {
  EXPECT_EQ(sample_table().to_markdown(),
            "| law | least P [J] | remark |\n|---|---|---|\n"
            "| none | **-0.651** | gives energy away, \"much\" \\| more |\n"
            "| fba-exact | **0** | |\n"
            "| wave | refuses: the device has no damping | |\n");
}

TEST(Table, QuotesInCommaSeparatedValuesWhatNeedsIt) {
  EXPECT_EQ(sample_table().to_csv(),
            "law,least P [J],remark\n"
            "none,-0.651,\"gives energy away, \"\"much\"\" | more\"\n"
            "fba-exact,0,\n"
            "wave,refuses: the device has no damping,\n");
}

TEST(Table, HasHeadingsThatTakeNoColumn) {
  Table table({{"law"}, {"P"}});
  table.add_heading("on a device of a kind that takes many words");
  table.add({"none", "1"});
  EXPECT_EQ(table.to_text(), "  law   P\n  on a device of a kind that takes many words\n  none  1\n");
  EXPECT_EQ(table.to_markdown(),
            "| law | P |\n|---|---|\n| **on a device of a kind that takes many words** | |\n| none | 1 |\n");
  EXPECT_EQ(table.to_csv(), "law,P\nnone,1\n");
}

TEST(Table, RefusesARowOfAnotherLength) {
  Table table({{"law"}, {"P"}});
  EXPECT_THAT([&] { table.add({"none"}); },
              testing::ThrowsMessage<std::invalid_argument>("a row of 1 cells in a table of 2 columns"));
  EXPECT_THROW(Table({}), std::invalid_argument);
}

TEST(Table, ShowsNoControlCharactersOfItsCells) {
  Table table({{"run\x1b[2J"}, {"P"}});
  table.add_heading("one\nforged");
  table.add({"a\x1b[31m.mcap", "1\r"});
  table.add_remark("b\x07", "refuses: \x9b");
  for (const std::string& text : {table.to_text(), table.to_markdown(), table.to_csv()}) {
    EXPECT_EQ(text.find_first_of("\x1b\r\x07\x9b"), std::string::npos) << text;
    EXPECT_EQ(text.find("\nforged"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace forcebound::text
