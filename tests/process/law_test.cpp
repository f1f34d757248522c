#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

std::string file_of(const std::string& name) {
  return std::string(FORCEBOUND_TEST_LAWS) + "/forcebound-law-" + name + ".so";
}

/// The columns of a comparison's runs, by law.
std::map<std::string, std::vector<std::vector<std::string>>> runs_of(const std::string& csv) {
  std::map<std::string, std::vector<std::vector<std::string>>> runs;
  std::istringstream rows(csv);
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row)) {
    std::vector<std::string> cells;
    std::istringstream columns(row);
    for (std::string cell; std::getline(columns, cell, ',');) cells.push_back(cell);
    runs[cells.front()].emplace_back(cells.begin() + 1, cells.end());
  }
  return runs;
}

const nlohmann::json& standing_of(const nlohmann::json& standings, const std::string& law) {
  const auto& laws = standings.at("laws");
  return *std::ranges::find_if(laws, [&](const nlohmann::json& one) { return one.at("law") == law; });
}

TEST(LawInC, IsComparedAndAuditedAsTheLawOfThePaperThatItWrites) {
  const TemporaryFolder folder;
  const Ran lab = run(kLab,
                      {"compare", "--laws", "fba-less," + file_of("saver"), "--scenes", "wall", "--network", "none",
                       "--network", "delay 10ms", "--stiffness", "10000", "--no-limits", "--effort", "1", "--csv",
                       folder.file("runs.csv"), "--json", folder.file("standings.json")},
                      300s);
  ASSERT_EQ(lab.exit_code, 0) << lab.err;
  EXPECT_THAT(lab.out, HasSubstr("saver"));
  const auto runs = runs_of(content(folder.file("runs.csv")));
  ASSERT_EQ(runs.size(), 2U);
  const auto& own = runs.at("saver");
  const auto& paper = runs.at("fba-less");
  ASSERT_EQ(own.size(), paper.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    SCOPED_TRACE(own[i][2] + " " + own[i][3]);
    if (own[i][3] != "ideal") continue;  // ticks that are not punctual cost each of them something else
    const double saver_J = std::stod(own[i][6]);
    EXPECT_NEAR(saver_J, std::stod(paper[i][6]), 1e-6) << "least P";
    EXPECT_NEAR(std::stod(own[i][9]), std::stod(paper[i][9]), 0.01 * std::stod(paper[i][9])) << "displayed stiffness";
    EXPECT_GE(saver_J, -1e-9) << "it promises that";
  }
  const nlohmann::json standings = nlohmann::json::parse(content(folder.file("standings.json")));
  EXPECT_FALSE(standing_of(standings, "saver").contains("law_faults"));
  EXPECT_GT(standing_of(standings, "saver").at("work_ns").get<double>(), 0);
}

TEST(LawInC, ThatGivesNoNumbersIsZeroForceAndCountedInTheComparison) {
  const TemporaryFolder folder;
  const Ran lab =
      run(kLab,
          {"compare", "--laws", file_of("failing") + "," + file_of("refusing"), "--scenes", "wall", "--network", "none",
           "--stiffness", "10000", "--no-limits", "--effort", "1", "--json", folder.file("standings.json")},
          300s);
  ASSERT_EQ(lab.exit_code, 0) << lab.err;
  const nlohmann::json standings = nlohmann::json::parse(content(folder.file("standings.json")));
  const nlohmann::json& failing = standing_of(standings, "failing");
  EXPECT_GT(failing.at("law_faults").get<std::uint64_t>(), 1000U);
  EXPECT_GE(failing.at("real").at("least_P_J").get<double>(), -1e-9) << "no force";
  EXPECT_THAT(unwrapped(lab.out), HasSubstr("failing gave no force, or none that is finite, on"));
  EXPECT_EQ(standing_of(standings, "refusing").at("refused").at("wall"), "law 'refusing': no device is good enough");
}

TEST(LawInC, PlaysTrialsBesideOthers) {
  const Ran lab = run(
      kLab, {"trials", "wall", "--laws", file_of("saver") + ",none", "--netem", "delay 20ms", "--seconds", "2"}, 120s);
  ASSERT_EQ(lab.exit_code, 0) << lab.err;
  EXPECT_THAT(lab.out, AllOf(HasSubstr("saver  no network"), HasSubstr("saver  local"), HasSubstr("none   remote")));
}

/// One session of a client whose law is this one.
nlohmann::json summary_with(const std::string& law) {
  Server server{Words{"--scene", "gravity"}};
  Client client(server.address(), {"--law", file_of(law), "--device", "cartesian-3dof", "--operator", "trace-sphere",
                                   "--rendering", "remote", "--duration", "1"});
  const auto ended = client.wait(60s);
  EXPECT_EQ(ended, client.expected_end()) << client.err();
  return client.summary();
}

TEST(LawInC, RunsInTheClient) {
  const nlohmann::json summary = summary_with("longer");
  EXPECT_EQ(summary.at("law"), "longer");
  EXPECT_EQ(summary.at("run").at("law_parameters"), "gain 1");
  EXPECT_GT(summary.at("force_N").at("max").get<double>(), 0);
  EXPECT_EQ(summary.at("faults").at("law_faults"), 0);
}

TEST(LawInC, ThatIsFaultyOrSlowIsHeldAtZeroForceAndCounted) {
  const nlohmann::json failing = summary_with("failing");
  EXPECT_GT(failing.at("faults").at("law_faults").get<int>(), 10);
  EXPECT_EQ(failing.at("force_N").at("max").get<double>(), 0);
  const nlohmann::json slow = summary_with("slow");
  EXPECT_GT(slow.at("faults").at("withdrawn_forces").get<int>(), 10);
  EXPECT_EQ(slow.at("force_N").at("max").get<double>(), 0);
}

TEST(LawInC, ThatCrashesEndsTheProgramWithALineThatNamesIt) {
  const Ran lab = run(kLab, {"trials", "wall", "--laws", file_of("crashing"), "--seconds", "1"});
  EXPECT_EQ(lab.exit_code, kDriverCrashed) << lab.out;
  EXPECT_THAT(lab.err, HasSubstr("forcebound-lab: law 'crashing' crashed in tick (Aborted)\n"));
}

TEST(LawInC, IsRefusedInOneLine) {
  for (const auto& [law, why] : {std::pair<std::string, std::string>("newer", "has interface 99, this program has 1"),
                                 {"empty", "is no law: it lacks the function 'forcebound_law_entry'"},
                                 {"mute", "lacks the function 'tick'"}}) {
    const std::vector<std::pair<const char*, Words>> programs{
        {kLab, {"compare", "--laws", file_of(law)}},
        {kLab, {"trials", "wall", "--laws", file_of(law)}},
        {kClient, {"--server", "127.0.0.1:9", "--law", file_of(law)}},
        {kForcebound, {"replay", "--damping", "30", "--law", file_of(law)}}};
    const std::string line = file_of(law).substr(file_of(law).rfind('/') + 1) + ": " + why;
    for (const auto& [program, words] : programs) {
      const Ran ran = run(program, words);
      EXPECT_EQ(ran.exit_code, 2) << ran.out;
      EXPECT_THAT(ran.err, AllOf(HasSubstr("--law"), HasSubstr(line)));
      EXPECT_EQ(ran.out, "");
    }
  }
  EXPECT_THAT(run(kClient, {"--server", "127.0.0.1:9", "--law", "./nowhere.so"}).err,
              HasSubstr("law ./nowhere.so: cannot be loaded: there is no such file"));
}

}  // namespace
}  // namespace forcebound::test
