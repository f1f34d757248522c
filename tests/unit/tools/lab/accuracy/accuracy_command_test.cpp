#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/support/process.hpp"
#include "tests/support/source_folder.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/unit/tools/lab/accuracy/body_scenes.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

void run_accuracy(std::vector<std::string> options) {
  CLI::App program{"test"};
  add_accuracy(program);
  options.insert(options.begin(), "accuracy");
  std::ranges::reverse(options);  // as CLI11 takes them
  program.parse(std::move(options));
}

TEST(AccuracyOfAStudy, IsWrittenAgainWithoutARun) {
  const test::TemporaryFolder folder;
  const std::string study = (test::source_folder() / "deploy/accuracy-results.json").string();
  test::write_file(folder.file("page.md"),
                   "before\n<!-- accuracy: made by deploy/accuracy -->\n<!-- /accuracy -->\nafter\n");
  run_accuracy({study, "--json", folder.file("again.json"), "--readme", folder.file("page.md")});
  EXPECT_EQ(nlohmann::json::parse(test::content(folder.file("again.json"))),
            nlohmann::json::parse(test::content(study)));
  const std::string page = test::content(folder.file("page.md"));
  EXPECT_THAT(page, testing::AllOf(testing::StartsWith("before\n"), HasSubstr("| `tissue.pad.shape.cells` | a step"),
                                   testing::EndsWith("<!-- /accuracy -->\nafter\n")));
}

TEST(AccuracyOfAStudy, RefusesWhatNeedsAScene) {
  const test::TemporaryFolder folder;
  const std::string study = (test::source_folder() / "deploy/accuracy-results.json").string();
  const auto expect_refused = [&](const std::string& option, const std::string& value) {
    EXPECT_THAT(
        [&] {
          run_accuracy({study, option, value});
        },
        testing::ThrowsMessage<std::invalid_argument>(HasSubstr("need a scene")));
  };
  expect_refused("--sweep", "law=none");
  expect_refused("--set", "a.b=1");
  expect_refused("--levels", "x.toml");
  test::write_file(folder.file("other.json"), R"({"laws": []})");
  EXPECT_THAT([&] { run_accuracy({folder.file("other.json")}); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("other.json: not a study")));
}

class AccuracyCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!server::has_bodies()) GTEST_SKIP() << "built without MuJoCo";
  }
  AccuracyCommandTest() { test::write_file(folder_.file("stack.toml"), stack_text()); }

  void run(std::vector<std::string> options) const {
    options.insert(options.begin(), {folder_.file("stack.toml"), "--rtt", "1", "--duration", "0.4"});
    run_accuracy(std::move(options));
  }

  [[nodiscard]] std::string refusal_of(const std::vector<std::string>& options) const {
    try {
      run(options);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "no error";
  }

  test::TemporaryFolder folder_;
};

TEST_F(AccuracyCommandTest, ChangesTheSceneBeforeTheSweepAsOftenAsToldTo) {
  const std::string file = folder_.file("result.json");
  run({"--set", "bodies.solver='pgs'", "--set", "bodies.timestep_s=0.002", "--sweep", "bodies.iterations=2,50",
       "--json", file});
  const auto result = nlohmann::json::parse(test::content(file));
  EXPECT_EQ(result["set"], "bodies.solver='pgs', bodies.timestep_s=0.002");
  EXPECT_EQ(result["ticks_between_states"], 4) << "two steps of 2 ms";
  ASSERT_EQ(result["settings"].size(), 2U);
  EXPECT_EQ(result["settings"][0]["value"], "2");
  EXPECT_EQ(result["settings"][0]["bodies"]["ticks"], 199);
  EXPECT_GT(result["settings"][0]["bodies"]["exhausted"], 190);
  EXPECT_GT(result["answer_bytes"], 100);
}

TEST_F(AccuracyCommandTest, RefusesWhatCannotBeSet) {
  EXPECT_THAT(refusal_of({"--set", "bodies.iterations=1,2"}), HasSubstr("--set takes one value"));
  EXPECT_THAT(refusal_of({"--set", "bodis.iterations=1"}), HasSubstr("no 'bodis', did you mean 'bodies'?"));
  EXPECT_THAT(refusal_of({"--set", "bodies.iterations"}), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(refusal_of({"--set", "law=none"}), HasSubstr("for 'law' use its own option"));
}

TEST_F(AccuracyCommandTest, SaysFileAndLineOfWhatIsWrongInAScene) {
  EXPECT_THAT(refusal_of({"--set", "body.low.mass_kg=-1"}), HasSubstr("stack.toml:14: "));
  EXPECT_THAT(refusal_of({"--sweep", "body.low.mas_kg=1,2"}),
              testing::ContainsRegex("stack.toml:1[0-9]: .*unknown key 'mas_kg'"));
  test::write_file(folder_.file("stack.toml"), "[scene]\nname = 's'\nnot toml\n");
  EXPECT_THAT(refusal_of({}), HasSubstr("stack.toml:3: "));
  test::write_file(folder_.file("stack.toml"), "[scene]\nname = 's'\n[[object]]\nnam = 1\n");
  EXPECT_THAT(refusal_of({}), HasSubstr("stack.toml:"));
}

TEST_F(AccuracyCommandTest, SweepsAlsoWhatIsOfTheSession) {
  const std::string file = folder_.file("result.json");
  run({"--sweep", "law=none,fba-exact", "--rtt", "0.02s", "--json", file});
  const auto result = nlohmann::json::parse(test::content(file));
  EXPECT_EQ(result["same_scene"], true);
  ASSERT_EQ(result["settings"].size(), 2U);
  EXPECT_EQ(result["settings"][0]["behind"].back()["round_trip_s"], 0.02);
  EXPECT_EQ(result["settings"][0]["behind"].back()["bounding"]["alone"], 0);
}

TEST_F(AccuracyCommandTest, RefusesAnUnknownMotionAndOptionsThatARecordedHandLacks) {
  EXPECT_THAT(refusal_of({"--motion", "wave"}), HasSubstr("press, slide or replay:FILE.csv, got 'wave'"));
  EXPECT_THAT(refusal_of({"--motion", "replay:h.csv", "--depth", "0.1"}), HasSubstr("recorded hand"));
}

}  // namespace
}  // namespace forcebound::lab
