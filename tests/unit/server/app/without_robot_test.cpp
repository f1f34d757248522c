#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "forcebound/program/command_line.hpp"
#include "forcebound/server/app/led_robot.hpp"
#include "forcebound/server/app/options.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(AServerWithoutRobots, RefusesEachOptionOnThemInALineWhichSaysHowToHaveThem) {
  for (const std::vector<const char*>& words : {std::vector<const char*>{"--follower", "reach-7", "--task", "plug"},
                                                {"--follower", "driver:./arm.so"},
                                                {"--task", "plug"},
                                                {"--architecture", "position-force"},
                                                {"--follower-law", "none"},
                                                {"--motion-scale", "1"},
                                                {"--force-scale", "1"},
                                                {"--approach-speed", "0.1"}}) {
    std::vector<const char*> line{"forcebound-server"};
    line.insert(line.end(), words.begin(), words.end());
    try {
      (void)parse_command_line(static_cast<int>(line.size()), line.data());
      ADD_FAILURE() << words.front() << " is accepted";
    } catch (const program::End& end) {
      EXPECT_EQ(end.exit_code, program::kWrongUse);
      EXPECT_THAT(end.text,
                  AllOf(HasSubstr(words.front()), HasSubstr("without robots"), HasSubstr("-DFORCEBOUND_ROBOT=ON")));
      EXPECT_EQ(end.text.find('\n'), end.text.size() - 1) << end.text;
    }
  }
}

TEST(AServerWithoutRobots, SaysSoInItsHelpAndServesScenes) {
  EXPECT_THAT(robot_help(), HasSubstr("-DFORCEBOUND_ROBOT=ON"));
  const char* const line = "forcebound-server";
  EXPECT_FALSE(parse_command_line(1, &line).start_robot);
}

}  // namespace
}  // namespace forcebound::server
