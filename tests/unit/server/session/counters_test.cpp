#include "forcebound/server/session/counters.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

TEST(ServerCounters, TextLeavesOutZeroCounts) {
  EXPECT_EQ(ServerCounters{}.text(),
            "sessions: 0 opened\n"
            "motions: 0 received\n"
            "forces: 0 sent\n"
            "pieces of scenes: 0 sent\n"
            "datagrams: 0 received\n");
}

TEST(ServerCounters, NameEveryReason) {
  ServerCounters counters;
  counters.datagrams = 9;
  counters.malformed = {1, 2, 3, 4, 5, 6};
  counters.motions_received = 7;
  counters.motions_reordered = 2;
  EXPECT_EQ(counters.text(),
            "sessions: 0 opened\n"
            "motions: 7 received, 2 reordered\n"
            "forces: 0 sent\n"
            "pieces of scenes: 0 sent\n"
            "datagrams: 9 received, 1 oversize, 2 truncated, 3 foreign, 4 corrupt, 5 unreadable, 6 not finite\n");
}

}  // namespace
}  // namespace forcebound::server
