#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/page.hpp"

// What the pages quote from the programs is what these print. Runs are in virtual time, which repeats on every machine,
// but for the client's summary: of that the lines are compared, not the numbers in them.
namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// As a block of code in Markdown, without blanks at the ends of lines.
std::string as_code(const std::string& printed) {
  std::istringstream lines(printed);
  std::string block;
  for (std::string line; std::getline(lines, line);) {
    line.erase(line.find_last_not_of(' ') + 1);
    block += (line.empty() ? "" : "    ") + line + "\n";
  }
  return block;
}

/// From the first occurrence of `begin` to the next of `end`, without that.
std::string part_of(const std::string& text, std::string_view begin, std::string_view end) {
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return {};
  return text.substr(at, text.find(end, at + begin.size()) - at);
}

TEST(Pages, ShowTheTrialsThatTheDemoEndsWith) {
  const Ran ran = run(kLab, {"trials"}, 120s);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  expect_on_page("README.md", "trials", as_code(ran.out));
}

TEST(Pages, SayOfHowManyFunctionsADriverIs) {
  const std::string header = content(source_folder() / "common/forcebound/driver/forcebound_device.h");
  const std::string table = part_of(header, "typedef struct forcebound_driver {", "/* Of robots; not there");
  ASSERT_FALSE(table.empty());
  ASSERT_EQ(occurrences(table, "(*"), 8U) << "say on both pages how many there are";
  EXPECT_THAT(unwrapped(content(source_folder() / "README.md")),
              testing::HasSubstr("a driver is eight functions in C"));
  EXPECT_THAT(unwrapped(content(source_folder() / "common/forcebound/driver/README.md")),
              testing::HasSubstr("what its eight functions do"));
}

TEST(Pages, ExplainTheBallOfTheFirstPage) {
  const TemporaryFolder folder;
  const std::string readme = content(source_folder() / "README.md");
  write_file(folder.file("ball.toml"), part_of(readme, "[scene]", "```"));
  const Ran ran = run(kServer, {"--scene", folder.file("ball.toml"), "--explain"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  expect_on_page("server/README.md", "explain", as_code(part_of(ran.out, "object 'ball'", "field ")));
}

/// Three digits; 0 for what is left by rounding.
std::string three_digits(const json& value, double unit) {
  constexpr double kRounding = 1e-9;
  if (!value.is_number()) return "-";
  const double number = value.get<double>() / unit;
  return text::rounded(std::fabs(number) < kRounding ? 0 : number);
}

TEST(Pages, ShowThePapersExperiments) {
  const TemporaryFolder folder;
  const Ran ran = run(kLab, {"reproduce", "all", "--json", folder.file("runs.json")}, 120s);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  text::Table table(
      {{"law", "", text::Table::Align::left}, {"least P", "mJ"}, {"K", "N/mm"}, {"var F", "N^2"}, {"rings", "s"}});
  std::string heading_above;
  for (const json& one : json::parse(content(folder.file("runs.json")))) {
    const std::string delay_ms = three_digits(one["one_way_delay_s"], 1e-3);
    const std::string heading = one["experiment"].get<std::string>() + ", K " +
                                three_digits(one["stiffness_N_per_m"], 1e3) + " N/mm" +
                                (delay_ms == "0" ? "" : ", " + delay_ms + " ms each way") + ", encoder " +
                                three_digits(one["encoder_m"], 1e-6) + " um";
    if (heading != heading_above) table.add_heading(heading);
    heading_above = heading;
    table.add({one["law"].get<std::string>(), three_digits(one["passivity"]["minimum_J"], 1e-3),
               three_digits(one["displayed_stiffness_N_per_m"]["median"], 1e3),
               three_digits(one["force_N"]["variance"], 1), three_digits(one["ringing_s"], 1)});
  }
  expect_on_page("tests/tools/lab/README.md", "experiments", as_code(table.to_text()));
}

/// The names at the beginning of a summary's lines.
std::vector<std::string> names_in(std::string_view block) {
  constexpr std::size_t kIndent = 6;  // of a summary's line, as code in Markdown
  std::istringstream lines{std::string(block)};
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() <= kIndent || line[kIndent] == ' ' || line.find_first_not_of(' ') != kIndent) continue;
    names.push_back(line.substr(kIndent, line.find("  ", kIndent) - kIndent));
  }
  return names;
}

TEST(Pages, ShowTheLinesOfASummary) {
  const Server server({"--scene", "sphere"});
  const Relay relay(server.address(), {"--netem", "delay 50ms 10ms loss 5%", "--seed", "1"});
  Client client(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--seed", "1", "--once", "--quiet",
                                  "--duration", writes_pages() ? "12" : "3"});
  ASSERT_EQ(client.wait(60s), 0);
  const std::string block = as_code(client.out());
  EXPECT_THAT(names_in(block), testing::Contains("force age")) << client.out();
  replace_or_compare("client/README.md", "summary", block,
                     [&](std::string_view on_page) { EXPECT_EQ(names_in(on_page), names_in(block)); });
}

}  // namespace
}  // namespace forcebound::test
