#include "forcebound/client/app/screen.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <vector>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

class ScreenLog : public testing::Test {
 protected:
  std::vector<std::string> lines_;
  Options options_;
  LiveLine line_;
  EventQueue events_;
  Screen screen_{options_, line_, events_, [this](const EventWords& words) { lines_.push_back(words.text); }};
};

TEST_F(ScreenLog, TellsOnceThatThereIsNoAnswer) {
  screen_.refresh(1s, 1s, "10.0.0.1:47800");
  screen_.refresh(3s, 3s, "10.0.0.1:47800");
  screen_.refresh(4s, 4s, "10.0.0.1:47800");
  EXPECT_THAT(lines_, ElementsAre("no answer from 10.0.0.1:47800 yet; retrying"));
}

TEST_F(ScreenLog, TellsWhyThereIsNoSessionAndNotAlsoThatThereIsNoAnswer) {
  screen_.report_problem("10.0.0.1:47800 does not let this client in");
  screen_.refresh(3s, 3s, "10.0.0.1:47800");
  EXPECT_THAT(lines_, ElementsAre("10.0.0.1:47800 does not let this client in; retrying"));
}

}  // namespace
}  // namespace forcebound::client
