#include <gmock/gmock.h>

#include "forcebound/client/app/event_words.hpp"
#include "forcebound/client/app/live_line.hpp"

namespace forcebound::client {
namespace {

using enum control::FollowerState;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string told(control::FollowerState state, std::string_view how = {}) {
  Event event{.kind = Event::Kind::follower_changed, .follower = state};
  event.set_text(how);
  return words_of(event).text;
}

TEST(EventsOfARobot, SayWhatItDoesAndHowToEngage) {
  EXPECT_EQ(told(waiting, "keep the device still for a moment"),
            "the robot waits: keep the device still for a moment, and it follows");
  EXPECT_EQ(told(following), "the robot follows");
  EXPECT_EQ(told(stopped, "press and release the clutch"),
            "the robot has stopped: press and release the clutch, and it follows again");
  EXPECT_THAT(told(holding), HasSubstr("holds"));
  EXPECT_THAT(told(failed), HasSubstr("server's log"));
  EXPECT_THAT(told(taken), HasSubstr("another device leads the robot"));
}

TEST(EventsOfARobot, HaveWordsForEachState) {
  for (std::uint8_t i = 0; i < control::kFollowerStates; ++i) {
    EXPECT_FALSE(told(static_cast<control::FollowerState>(i)).empty()) << int{i};
  }
}

TEST(LiveLine, ShowsTheRobotsStateWhereThereIsOne) {
  LiveLine line;
  record::ForceRecord force;
  constexpr std::size_t kWide = 200;
  line.on_force(force);
  EXPECT_THAT(line.text(kWide), Not(HasSubstr("robot")));
  force.force.answer.follower = holding;
  line.on_force(force);
  EXPECT_THAT(line.text(kWide), HasSubstr("0 ticks  robot holding  0.000 N"));
}

}  // namespace
}  // namespace forcebound::client
