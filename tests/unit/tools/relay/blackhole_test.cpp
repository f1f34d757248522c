#include "tests/tools/relay/blackhole.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

namespace forcebound::relay {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(BlackholeOption, NamesWaysAndSeconds) {
  const BlackholeOption up = parse_blackhole("up:5-65");
  EXPECT_TRUE(up.up && !up.down);
  EXPECT_EQ(up.when.from, 5s);
  EXPECT_EQ(up.when.to, 65s);
  const BlackholeOption down = parse_blackhole("down:0-0.25");
  EXPECT_TRUE(!down.up && down.down);
  EXPECT_EQ(down.when.to, 250ms);
  const BlackholeOption both = parse_blackhole("both:1.5-3");
  EXPECT_TRUE(both.up && both.down);
  EXPECT_EQ(both.when.from, 1500ms);
}

TEST(BlackholeOption, RefusesAnInvalidTextAndNamesTheAcceptedForm) {
  for (const char* text : {"", "up", "up:", "up:5", "up:5-", "up:-5-6", "up:6-5", "up:5-5", "left:1-2", "up:a-b",
                           "up:nan-inf", "up:1-1e9", "up:1-99999999", "up 1-2", "-:1"}) {
    EXPECT_THAT([&] { parse_blackhole(text); },
                ThrowsMessage<std::invalid_argument>(
                    AllOf(HasSubstr("'" + std::string(text) + "' is not a blackhole"), HasSubstr("as in up:5-65"))))
        << text;
  }
}

}  // namespace
}  // namespace forcebound::relay
