#include "tests/tools/relay/control.hpp"

#include <gmock/gmock.h>

#include "tests/unit/tools/relay/kept_links.hpp"

namespace forcebound::relay {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class RelayControl : public testing::Test {
 protected:
  void client_sends(Nanoseconds now) {
    downstream_.waiting.emplace_back(1, "a");
    relay_.receive(now);
    relay_.forward(now);
  }
  [[nodiscard]] std::size_t arrived() const { return upstream_.links.at(0)->sent.size(); }

  KeptLink downstream_;
  KeptUpstream upstream_;
  Relay relay_{RelaySettings{.up = {.netem = netem::parse_netem("delay 10ms")}, .upstream = at(kServerPort)},
               downstream_, upstream_, nullptr};
  Control control_{relay_, {.up = "delay 10ms", .down = ""}};
};

TEST_F(RelayControl, ChangesWhatComesFromNowOnAndLeavesWhatWaits) {
  client_sends(0ms);
  const Control::Answer answer = control_.answer("up delay  30ms\n", 1ms);
  EXPECT_TRUE(answer.changed);
  EXPECT_EQ(answer.text, "up: delay 30ms; down: perfect");
  client_sends(1ms);
  relay_.forward(10ms);
  EXPECT_EQ(arrived(), 1U);
  EXPECT_EQ(relay_.next_departure(), 31ms);
}

TEST_F(RelayControl, TakesEachDirectionAloneOrBoth) {
  EXPECT_EQ(control_.answer("down loss 5%", 0ms).text, "up: delay 10ms; down: loss 5%");
  EXPECT_EQ(control_.answer("both delay 1000", 0ms).text, "up: delay 1000us; down: delay 1000us");
  EXPECT_EQ(control_.answer("up\n", 0ms).text, "up: perfect; down: delay 1000us");
  client_sends(0ms);
  EXPECT_EQ(arrived(), 1U);
}

TEST_F(RelayControl, TellsItsStateWithoutChangingIt) {
  const Control::Answer answer = control_.answer("status", 0ms);
  EXPECT_FALSE(answer.changed);
  EXPECT_EQ(answer.text, "up: delay 10ms; down: perfect");
}

TEST_F(RelayControl, ChangesNothingForALineThatIsWrong) {
  for (const char* line : {"", "sideways delay 1ms", "status now", "up delay", "both loss 200%", "up lost 5%"}) {
    SCOPED_TRACE(line);
    const Control::Answer answer = control_.answer(line, 0ms);
    EXPECT_FALSE(answer.changed);
    EXPECT_THAT(answer.text, StartsWith("error: "));
    EXPECT_EQ(control_.answer("status", 0ms).text, "up: delay 10ms; down: perfect");
  }
  EXPECT_THAT(control_.answer("sideways\x1b[2J", 0ms).text, HasSubstr("'sideways?[2J'"));
  EXPECT_THAT(control_.answer("sideways 1ms\r\n", 0ms).text, HasSubstr("got 'sideways 1ms'")) << "as echo ends a line";
}

}  // namespace
}  // namespace forcebound::relay
