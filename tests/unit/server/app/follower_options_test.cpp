#include "forcebound/server/app/follower_options.hpp"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/server/app/options.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

FollowerOptions follower_parsed(std::vector<const char*> words) {
  words.insert(words.begin(), "forcebound-server");
  FollowerOptions options;
  CLI::App app;
  add_follower_options(app, options, baselines::shipped_laws());
  program::parse(app, static_cast<int>(words.size()), words.data());
  return options;
}

ProgramOptions server_parsed(std::vector<const char*> words) {
  words.insert(words.begin(), "forcebound-server");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

/// What is said about a command line that is refused, in one line.
std::string refusal_of(const std::vector<const char*>& words) {
  std::string said;
  try {
    (void)server_parsed(words);
    ADD_FAILURE() << "accepted";
  } catch (const program::End& end) {
    EXPECT_EQ(end.exit_code, program::kWrongUse);
    said = end.text;
  } catch (const std::invalid_argument& error) {
    said = error.what();
  }
  EXPECT_THAT(said.substr(0, said.find_last_not_of('\n') + 1), Not(HasSubstr("\n")));
  return said;
}

TEST(FollowerOptions, SayRobotTaskAndHowTheyWork) {
  const FollowerOptions options =
      follower_parsed({"--follower", "reach-7", "--task", "plug", "--architecture", "model-mediated", "--follower-law",
                       "none", "--motion-scale", "0.5", "--force-scale", "0.25", "--approach-speed", "0.1"});
  EXPECT_TRUE(options.any());
  EXPECT_EQ(options.robot, "reach-7");
  EXPECT_EQ(options.task, "plug");
  EXPECT_EQ(options.settings.architecture, "model-mediated");
  EXPECT_EQ(options.settings.law, "none");
  EXPECT_EQ(options.settings.workspace.motion_scale, 0.5);
  EXPECT_EQ(options.settings.workspace.force_scale, 0.25);
  EXPECT_EQ(options.settings.approach_m_per_s_max, 0.1);
  EXPECT_FALSE(follower_parsed({}).any());
}

TEST(FollowerOptions, StartARobotOnlyWhereOneIsAskedFor) {
  EXPECT_TRUE(server_parsed({"--follower", "reach-7", "--task", "plug"}).start_robot);
  EXPECT_FALSE(server_parsed({}).start_robot);
}

TEST(FollowerOptions, RefuseWhatDoesNotExistNamingTheNearest) {
  EXPECT_THAT(refusal_of({"--follower", "reach7", "--task", "plug"}),
              AllOf(HasSubstr("--follower"), HasSubstr("'reach7'"), HasSubstr("did you mean 'reach-7'")));
  EXPECT_THAT(
      refusal_of({"--follower", "reach-7", "--task", "plugg"}),
      AllOf(HasSubstr("--task"), HasSubstr("'plugg'"), HasSubstr("did you mean 'plug'"), HasSubstr("FILE.toml")));
  EXPECT_THAT(refusal_of({"--follower", "reach-7", "--task", "plug", "--architecture", "position-forces"}),
              AllOf(HasSubstr("--architecture"), HasSubstr("did you mean 'position-force'")));
  EXPECT_THAT(refusal_of({"--follower", "reach-7", "--task", "plug", "--follower-law", "fba-exakt"}),
              AllOf(HasSubstr("--follower-law"), HasSubstr("did you mean 'fba-exact'")));
}

TEST(FollowerOptions, RefuseATaskFileWithItsLine) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("my.toml");
  const auto parse = [&] { (void)server_parsed({"--follower", "reach-7", "--task", file.c_str()}); };
  EXPECT_THAT(parse, testing::ThrowsMessage<std::runtime_error>(HasSubstr("my.toml: cannot be read")));
  text::write_file(file, "summary = 3\n");
  EXPECT_THAT(parse, testing::ThrowsMessage<std::exception>(HasSubstr("my.toml")));
}

TEST(FollowerOptions, BelongTogether) {
  EXPECT_THAT(refusal_of({"--follower", "reach-7"}), HasSubstr("--task"));
  EXPECT_THAT(refusal_of({"--task", "plug"}), HasSubstr("--follower"));
  for (const char* const option : {"--architecture", "--follower-law"}) {
    EXPECT_THAT(refusal_of({option, option[2] == 'a' ? "position-force" : "none"}), HasSubstr("--follower")) << option;
  }
  for (const char* const option : {"--motion-scale", "--force-scale", "--approach-speed"}) {
    EXPECT_THAT(refusal_of({option, "0.5"}), HasSubstr("--follower")) << option;
    EXPECT_THAT(refusal_of({"--follower", "reach-7", "--task", "plug", option, "0"}),
                AllOf(HasSubstr(option), HasSubstr("got '0'")))
        << option;
  }
}

TEST(FollowerOptions, TakeARobotBehindADriverWithoutATask) {
  EXPECT_EQ(follower_parsed({"--follower", "driver:./arm.so:port=1"}).robot, "driver:./arm.so:port=1");
  EXPECT_EQ(follower_parsed({"--follower", "my-arm.toml"}).robot, "my-arm.toml");
  EXPECT_THAT(refusal_of({"--follower", "driver:./arm.so", "--task", "plug"}),
              HasSubstr("--task is for simulated robots; one behind a driver has work of its own"));
}

TEST(FollowerOptions, DoNotGoWithAScene) {
  EXPECT_THAT(refusal_of({"--follower", "reach-7", "--task", "plug", "--scene", "wall"}),
              AllOf(HasSubstr("--scene"), HasSubstr("--follower")));
  for (const char* const option : {"--explain", "--suggest"}) {
    EXPECT_THAT(refusal_of({"--follower", "reach-7", "--task", "plug", option}),
                AllOf(testing::StartsWith(option), HasSubstr(" a scene's "), HasSubstr("--follower has none")));
  }
}

TEST(FollowerOptions, OfferOnlyLawsThatNeedNothingFromElsewhere) {
  const auto laws = baselines::shipped_laws();
  const auto names = follower_laws(laws);
  EXPECT_THAT(names, Contains("fba-exact"));
  EXPECT_THAT(names, Contains("none"));
  EXPECT_LT(names.size(), laws.names().size());
  for (const std::string& name : names) EXPECT_FALSE(laws.find(name).make_server_side) << name;
}

}  // namespace
}  // namespace forcebound::server
