#include "tests/tools/relay/packet_rows.hpp"

#include <gtest/gtest.h>

namespace forcebound::relay {
namespace {

using namespace std::chrono_literals;
using netem::Fate;
using netem::Verdict;

class PacketRowsTest : public testing::Test {
 protected:
  std::string ready() {
    std::string text;
    rows_.take_ready(text);
    return text;
  }
  PacketRows rows_{1s};
};

TEST_F(PacketRowsTest, LostPacketsAreReadyAtOnceAndHaveNoDelay) {
  rows_.on_verdict(Direction::down, {.number = 1, .fate = Fate::lost, .arrival = 1s + 1500us});
  EXPECT_EQ(ready(), "down,1,1.500000,lost,\n");
  EXPECT_EQ(ready(), "");
}

TEST_F(PacketRowsTest, ForwardedPacketsAreReadyWithTheirFinalDelay) {
  rows_.on_verdict(Direction::up, {.number = 7, .arrival = 1s, .delay = 5ms});
  EXPECT_EQ(ready(), "");
  rows_.on_departure(Direction::up, {.number = 7, .arrival = 1s, .delay = 20ms + 1ns});
  EXPECT_EQ(ready(), "up,7,0.000000,forwarded,20.000001\n");
}

TEST_F(PacketRowsTest, RowsStayInTheOrderOfArrivalHoweverPacketsLeave) {
  const Verdict first{.number = 1, .arrival = 1s, .delay = 9ms};
  const Verdict copy{.number = 2, .copy = true, .arrival = 1s, .delay = 1ms};
  const Verdict original{.number = 2, .arrival = 1s, .delay = 2ms};
  for (const Verdict& verdict : {first, copy, original}) rows_.on_verdict(Direction::up, verdict);
  rows_.on_verdict(Direction::down, {.number = 1, .fate = Fate::over_limit, .arrival = 1s});
  rows_.on_departure(Direction::up, original);
  rows_.on_departure(Direction::up, copy);
  EXPECT_EQ(ready(), "down,1,0.000000,over-limit,\n");
  rows_.on_departure(Direction::up, first);
  EXPECT_EQ(ready(),
            "up,1,0.000000,forwarded,9.000000\n"
            "up,2,0.000000,duplicate+forwarded,1.000000\n"
            "up,2,0.000000,forwarded,2.000000\n");
}

TEST_F(PacketRowsTest, WhatHasNotLeftByTheEndIsWaiting) {
  rows_.on_verdict(Direction::up, {.number = 1, .arrival = 1s, .delay = 5ms});
  std::string text;
  EXPECT_EQ(rows_.take_all(text), 1U);
  EXPECT_EQ(text, "up,1,0.000000,waiting,\n");
}

TEST_F(PacketRowsTest, DepartureWithoutAVerdictMakesNoRow) {
  rows_.on_departure(Direction::up, {.number = 5, .arrival = 1s});
  rows_.on_verdict(Direction::up, {.number = 6, .arrival = 1s});
  rows_.on_departure(Direction::up, {.number = 5, .arrival = 1s});
  std::string text;
  EXPECT_EQ(rows_.take_all(text), 1U);
}

}  // namespace
}  // namespace forcebound::relay
