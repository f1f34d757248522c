#include "tests/tools/sim/busy_server.hpp"

#include <gtest/gtest.h>

#include <string>

namespace forcebound::sim {
namespace {

using std::chrono::milliseconds;

struct Turns {
  BusyServer server{milliseconds(3)};

  void arrive(char what, int ms) {
    const std::byte byte{static_cast<unsigned char>(what)};
    server.arrive({&byte, 1}, {}, milliseconds(ms));
  }
  std::string end_turn() {
    std::string all;
    server.end_turn([&](std::span<const std::byte> bytes, const Address&, Nanoseconds) {
      all += static_cast<char>(bytes.front());
    });
    return all;
  }
};

TEST(BusyServer, TakesInWhatHasComeAtTheBeginningOfEachTurn) {
  Turns turns;
  EXPECT_EQ(turns.server.next_event(), std::nullopt);
  turns.arrive('a', 0);
  turns.arrive('b', 1);
  turns.arrive('c', 2);
  EXPECT_EQ(turns.server.next_event(), milliseconds(3));
  EXPECT_EQ(turns.end_turn(), "a");
  turns.arrive('d', 4);
  EXPECT_EQ(turns.server.next_event(), milliseconds(6));
  EXPECT_EQ(turns.end_turn(), "bc");
  EXPECT_EQ(turns.end_turn(), "d");
  EXPECT_EQ(turns.server.next_event(), std::nullopt);
  turns.arrive('e', 20);
  EXPECT_EQ(turns.server.next_event(), milliseconds(23));
}

TEST(BusyServer, ForgetsWhatWaits) {
  Turns turns;
  turns.arrive('a', 0);
  turns.arrive('b', 1);
  turns.server.forget();
  EXPECT_EQ(turns.server.next_event(), std::nullopt);
}

}  // namespace
}  // namespace forcebound::sim
