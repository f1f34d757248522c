#include "haply_message.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>

namespace forcebound::haply {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::string kState =
    R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":0.01,"y":-0.12,"z":0.15}}},)"
    R"({"device_id":"04BA","state":{"cursor_position":{"x":0.25,"y":-0.5,"z":1}}}],)"
    R"("wireless_verse_grip":[{"state":{"orientation":{"w":0,"x":0,"y":0.6,"z":0.8},"buttons":{"a":true,"b":false,"c":true}}}]})";

std::string state_with(const std::string& position, const std::string& more = "") {
  return R"({"inverse3":[{"device_id":"04BA","state":{"cursor_position":)" + position + "}}]" + more + "}";
}

Answer answer_of(const std::string& text) {
  State state;
  return parse_state(text, "04BA", state);
}

TEST(HaplyMessage, TellsPositionOrientationAndButtonsOfTheDeviceAskedFor) {
  State state;
  ASSERT_EQ(parse_state(kState, "04BA", state), Answer::state);
  EXPECT_THAT(state.position_m, ElementsAre(0.25, -0.5, 1));
  ASSERT_TRUE(state.has_orientation);
  EXPECT_THAT(state.orientation, ElementsAre(0, 0, 0.6, 0.8));
  ASSERT_TRUE(state.has_buttons);
  EXPECT_EQ(state.buttons, 5U);
}

TEST(HaplyMessage, ReadsButtonsOfAllGrips) {
  State state;
  const std::string wired = R"(,"verse_grip":[{"state":{"button":true}}])";
  ASSERT_EQ(parse_state(state_with(R"({"x":0,"y":0,"z":0})", wired), "04BA", state), Answer::state);
  EXPECT_EQ(state.buttons, 1U);
  EXPECT_FALSE(state.has_orientation);
  const std::string numbered = R"(,"custom_verse_grip":[{"state":{"buttons":{"button_1":true,"button_3":true}}}])";
  ASSERT_EQ(parse_state(state_with(R"({"x":0,"y":0,"z":0})", numbered), "04BA", state), Answer::state);
  EXPECT_EQ(state.buttons, 10U);
}

TEST(HaplyMessage, TakesNoRotationFromAGripThatHasNotMeasuredYet) {
  State state;
  const std::string zeros = R"(,"verse_grip":[{"state":{"button":false,"orientation":{"w":0,"x":0,"y":0,"z":0}}}])";
  ASSERT_EQ(parse_state(state_with(R"({"x":0,"y":0,"z":0})", zeros), "04BA", state), Answer::state);
  EXPECT_FALSE(state.has_orientation);
  EXPECT_TRUE(state.has_buttons);
}

TEST(HaplyMessage, TellsAMissingDeviceFromAMessageThatIsNotUnderstood) {
  EXPECT_EQ(answer_of(R"({"inverse3":[]})"), Answer::gone);
  EXPECT_EQ(answer_of(R"({"inverse3":[{"device_id":"049D"}]})"), Answer::gone);
  for (const char* const text :
       {"", "null", "7", "[]", "{}", "{", R"({"inverse3":7})", R"({"inverse3":[{"device_id":"04BA"}]})",
        R"({"inverse3":[{"device_id":"04BA","state":[]}]})",
        R"({"inverse3":[{"device_id":"04BA","state":{"cursor_position":null}}]})"}) {
    EXPECT_EQ(answer_of(text), Answer::not_understood) << text;
  }
}

TEST(HaplyMessage, TakesOnlyFiniteNumbersWithinTenMetresForAPosition) {
  for (const char* const position :
       {R"({"x":0,"y":0})", R"({"x":"0","y":0,"z":0})", R"({"x":null,"y":0,"z":0})", R"({"x":true,"y":0,"z":0})",
        R"({"x":1e999,"y":0,"z":0})", R"({"x":NaN,"y":0,"z":0})", R"({"x":11,"y":0,"z":0})"}) {
    EXPECT_EQ(answer_of(state_with(position)), Answer::not_understood) << position;
  }
  EXPECT_EQ(answer_of(state_with(R"({"x":-10,"y":0,"z":0})")), Answer::state);
}

TEST(HaplyMessage, SurvivesDeepNesting) {
  const std::string deep(60000, '[');
  EXPECT_EQ(answer_of(deep), Answer::not_understood);
  EXPECT_EQ(answer_of(deep + std::string(60000, ']')), Answer::not_understood);
}

TEST(HaplyMessage, TakesNothingFromChangedMessagesButFinitePositionsAndRotations) {
  const std::uint32_t seed = 16;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  int states = 0;
  for (int run = 0; run < 50000; ++run) {
    std::string text = kState;
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, 1 + below(8));
          break;
        case 2:
          text.insert(at, text.substr(below(text.size()), below(20)));
          break;
        default:
          text.resize(std::max<std::size_t>(1, text.size() - below(10)));
      }
    }
    State state;
    if (parse_state(text, "04BA", state) != Answer::state) continue;
    ++states;
    for (const double x : state.position_m) ASSERT_LE(std::abs(x), 10) << text;
    const auto& q = state.orientation;
    ASSERT_NEAR(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])), 1, 1e-9) << text;
    (void)parse_inventory(text);
  }
  EXPECT_GT(states, 100) << "too few of the changed messages are still messages";
}

TEST(HaplyMessage, ListsDevicesAndKnowsSessions) {
  const auto older = parse_inventory(kState);
  ASSERT_TRUE(older);
  EXPECT_THAT(older->device_ids, ElementsAre("049D", "04BA"));
  EXPECT_FALSE(older->has_sessions);
  const auto newer = parse_inventory(R"({"session_id":7,"inverse3":[{"device_id":"a\"b"},{"device_id":7},5]})");
  ASSERT_TRUE(newer);
  EXPECT_THAT(newer->device_ids, IsEmpty()) << "ids that we could not send back";
  EXPECT_TRUE(newer->has_sessions);
  EXPECT_FALSE(parse_inventory(R"({"devices":[]})"));
  EXPECT_FALSE(parse_inventory("hello"));
}

TEST(HaplyMessage, SpellsAForceBothWays) {
  std::string text;
  write_command({.device_id = "04BA", .force_N = {1, -0.5, 1e-9}, .spelling = Spelling::vector}, text);
  EXPECT_EQ(text, R"({"inverse3":[{"device_id":"04BA","commands":)"
                  R"({"set_cursor_force":{"vector":{"x":1,"y":-0.5,"z":1e-09}}}}]})");
  write_command({.device_id = "04BA", .force_N = {1, 2, 3}, .spelling = Spelling::values, .introduces = true}, text);
  EXPECT_EQ(text,
            R"({"session":{"configure":{"profile":{"name":"forcebound"},"basis":{"permutation":"XYZ"}}},)"
            R"("inverse3":[{"device_id":"04BA","commands":{"set_cursor_force":{"values":{"x":1,"y":2,"z":3}}}}]})");
}

}  // namespace
}  // namespace forcebound::haply
