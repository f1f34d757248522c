#include "tests/tools/lab/accuracy/session_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string refusal_of(const std::string& key, const std::string& value) {
  try {
    static_cast<void>(with_session_key({}, key, value));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(SessionSettings, AreChangedKeyByKey) {
  EXPECT_EQ(with_session_key({}, "law", "fba-less").law, "fba-less");
  EXPECT_EQ(with_session_key({}, "law", "\"none\"").law, "none");
  EXPECT_EQ(with_session_key({}, "hold_ms", "0.5").policy.hold, 500us);
  EXPECT_EQ(with_session_key({}, "drop_ms", "300").policy.drop, 300ms);
  EXPECT_FALSE(SessionSettings{}.renders_locally);
  EXPECT_TRUE(with_session_key({}, "rendering", "local").renders_locally);
  EXPECT_FALSE(with_session_key({.renders_locally = true}, "rendering", "\"remote\"").renders_locally);
  EXPECT_DOUBLE_EQ(with_session_key({}, "rate_Hz", "50").server_turn_least_s(), 0.02);
  EXPECT_EQ(with_session_key({}, "rate_Hz", "1000").server_turn_least_s(), 0) << "it answers every motion at once";
}

TEST(SessionSettings, HaveKeysWithoutADotAndScenesHaveOneInTheirs) {
  EXPECT_TRUE(is_session_key("hold_ms"));
  EXPECT_FALSE(is_session_key("bodies.iterations"));
  for (const std::string& key : session_keys()) EXPECT_EQ(key.find('.'), std::string::npos) << key;
}

TEST(SessionSettings, SayWhatIsWrong) {
  EXPECT_THAT(refusal_of("law", "fba-les"), HasSubstr("unknown law 'fba-les', did you mean 'fba-less'?"));
  EXPECT_THAT(refusal_of("hold_ms", "-1"), HasSubstr("hold_ms must be a number >= 0, got '-1'"));
  EXPECT_THAT(refusal_of("hold_ms", "2000"), HasSubstr("0 <= hold <= drop"));
  EXPECT_THAT(refusal_of("rate_Hz", "0"), HasSubstr("rate_Hz must be a number > 0, got '0'"));
  EXPECT_THAT(refusal_of("rate_Hz", "fast"), HasSubstr("got 'fast'"));
  EXPECT_THAT(refusal_of("rendering", "locl"), HasSubstr("unknown rendering 'locl', did you mean 'local'?"));
  EXPECT_THAT(refusal_of("hold", "1"), HasSubstr("no 'hold', did you mean 'hold_ms'?"));
}

TEST(SessionSettings, AreSaidInALine) {
  EXPECT_EQ(to_text(SessionSettings{.law = "none", .policy = {.hold = 20ms, .drop = 300ms}, .server_rate_Hz = 50}),
            "law none, hold 20 ms, drop 300 ms, the server answers at most 50 motions a second, rendering remote");
}

}  // namespace
}  // namespace forcebound::lab
