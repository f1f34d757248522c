#include "forcebound/record/blackout.hpp"

#include <gtest/gtest.h>

namespace forcebound::record {
namespace {

using namespace std::chrono_literals;

constexpr const char* kServer = "127.0.0.1:47800";

TEST(ABlackout, WithLostAnswersDiedDown) {
  const Blackout blackout{
      .duration = 60s, .over = true, .counted = true, .motions = 60012, .answers = 60011, .lost_down = 60011};
  EXPECT_EQ(what_died(blackout), "down");
  EXPECT_EQ(words_of(blackout, kServer),
            "nothing came back from 127.0.0.1:47800 for 60.00 s: 60012 of 60012 motions arrived there (up alive), 0 of "
            "60011 answers came back (down dead)");
}

TEST(ABlackout, WithLostMotionsDiedUp) {
  const Blackout blackout{
      .duration = 3s, .over = true, .counted = true, .motions = 3000, .lost_up = 2990, .answers = 10};
  EXPECT_EQ(what_died(blackout), "up");
  EXPECT_EQ(words_of(blackout, kServer),
            "nothing came back from 127.0.0.1:47800 for 3.00 s: 10 of 3000 motions arrived there (up dead), 10 of 10 "
            "answers came back (down alive)");
}

TEST(ABlackout, EndedByAServerThatReceivedNoMotionDiedUp) {
  const Blackout blackout{
      .duration = 61s, .over = true, .counted = true, .server_left = true, .motions = 60000, .lost_up = 60000};
  EXPECT_EQ(what_died(blackout), "up");
  EXPECT_EQ(words_of(blackout, kServer),
            "nothing came back from 127.0.0.1:47800 for 61.00 s: 0 of 60000 motions arrived there (up dead), so no "
            "answer was due, and the server ended the session");
}

TEST(ABlackout, WithBothLostDiedInBothDirections) {
  EXPECT_EQ(what_died({.counted = true, .motions = 9, .lost_up = 8, .answers = 5, .lost_down = 4}), "both");
}

TEST(ABlackout, WithFewLossesDiedInNeitherDirection) {
  EXPECT_EQ(what_died({.counted = true, .motions = 8, .lost_up = 4, .answers = 8, .lost_down = 4}), "neither");
  const Blackout stopped{.duration = 2s, .over = true, .counted = true};
  EXPECT_EQ(what_died(stopped), "neither");
  EXPECT_EQ(words_of(stopped, kServer),
            "nothing came back from 127.0.0.1:47800 for 2.00 s: no motion was sent in it, so no answer was due");
}

TEST(ABlackout, WithoutCountsHasAnUnknownDirection) {
  EXPECT_EQ(what_died({.duration = 2s}), "unknown");
  EXPECT_EQ(words_of({.duration = 2s}, kServer),
            "nothing came back from 127.0.0.1:47800 for 2.00 s until the end: it is not known which direction "
            "lost the datagrams");
  EXPECT_EQ(words_of({.duration = 2s, .over = true}, kServer),
            "nothing came back from 127.0.0.1:47800 for 2.00 s: then in another session: the server had restarted or "
            "closed this one");
}

TEST(ABlackout, AfterTheServersByeDiedAtTheServer) {
  const Blackout blackout{.duration = 2s, .over = true, .server_left = true};
  EXPECT_EQ(what_died(blackout), "server");
  EXPECT_EQ(words_of(blackout, kServer),
            "nothing came back from 127.0.0.1:47800 for 2.00 s: the server had ended the session");
}

}  // namespace
}  // namespace forcebound::record
