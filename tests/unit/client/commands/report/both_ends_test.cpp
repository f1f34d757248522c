#include "forcebound/client/commands/report/both_ends.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace forcebound::client::commands {
namespace {

using namespace std::chrono_literals;
using record::Nanoseconds;
using testing::HasSubstr;

constexpr std::uint64_t kSession = 42;

/// One motion of the client's and what became of it. The server's steady clock is 1 h ahead of the client's.
struct Trip {
  std::uint64_t motion = 1;
  bool answered = true;
  bool came_back = true;
  std::uint64_t session = kSession;
  double force_N = 1;
  double force_at_client_N = 1;
};

constexpr Nanoseconds kAhead = 1h;
constexpr Nanoseconds kUp = 3ms;
constexpr Nanoseconds kServer = 1ms;
constexpr Nanoseconds kDown = 5ms;

void play(const Trip& trip, BothEnds& both) {
  const Nanoseconds read = trip.motion * 1ms;
  record::TickRecord tick;
  tick.time = read;
  tick.motion_sequence = trip.motion;
  both.add(tick);
  if (!trip.answered) return;
  record::MotionRecord motion{.receive_time = read + kUp + kAhead, .motion = {}};
  motion.motion.session = trip.session;
  motion.motion.sequence = trip.motion;
  both.add(motion);
  record::SentForceRecord sent;
  sent.force.session = trip.session;
  sent.force.sequence = trip.motion;
  sent.force.motion_sequence = trip.motion;
  sent.force.server_receive_time = motion.receive_time;
  sent.force.server_send_time = motion.receive_time + kServer;
  sent.force.compute_time = 200us;
  sent.force.answer.force = control::Vector::Constant(3, trip.force_N);
  both.add(sent);
  if (!trip.came_back) return;
  record::ForceRecord received{
      .receive_time = read + kUp + kServer + kDown, .round_trip = kUp + kServer + kDown, .force = {}};
  received.force = sent.force;
  received.force.answer.force.setConstant(trip.force_at_client_N);
  both.add(received);
}

void begin(BothEnds& both) {
  // What the steady clocks are apart, the epochs undo: both wall clocks agree.
  record::RunInfo client;
  client.epoch = 100h;
  record::RunInfo server;
  server.epoch = 100h - kAhead;
  both.add_client(client);
  both.add_server(server);
}

TEST(BothEnds, TellApartWhatWasLostOnWhichWay) {
  BothEnds both;
  begin(both);
  for (std::uint64_t n = 1; n <= 100; ++n) play({.motion = n, .answered = n % 5 != 0, .came_back = n % 10 != 1}, both);
  const auto results = both.results();
  EXPECT_EQ(results["sessions"], 1);
  EXPECT_EQ(results["motions"]["sent"], 100);
  EXPECT_EQ(results["motions"]["answered"], 80);
  EXPECT_EQ(results["motions"]["came_back"], 70);
  EXPECT_EQ(results["forces"]["sent"], 80);
  EXPECT_EQ(results["forces"]["received"], 70);
  EXPECT_EQ(results["forces"]["differ"], 0);
}

TEST(BothEnds, SplitTheRoundTripByTheWallClocks) {
  BothEnds both;
  begin(both);
  for (std::uint64_t n = 1; n <= 10; ++n) play({.motion = n}, both);
  const auto results = both.results();
  EXPECT_DOUBLE_EQ(results["up_us"]["p50"], 3000);
  EXPECT_DOUBLE_EQ(results["server_us"]["max"], 1000);
  EXPECT_DOUBLE_EQ(results["compute_us"]["p50"], 200);
  EXPECT_DOUBLE_EQ(results["down_us"]["p99"], 5000);
  EXPECT_DOUBLE_EQ(results["round_trip_us"]["p50"], 9000);
  EXPECT_TRUE(results["clocks_apart_us"].is_null());
  EXPECT_THAT(both.to_text(), HasSubstr("up            3 ms median"));
  EXPECT_THAT(both.to_text(), HasSubstr("is not known"));
}

TEST(BothEnds, SayHowFarTheClientFoundTheWallClocksApart) {
  BothEnds both;
  begin(both);
  play({}, both);
  record::RunTotals totals;
  totals.server_ahead = kAhead + 2ms;
  totals.server_ahead_off = 500us;
  both.add_client(totals);
  EXPECT_DOUBLE_EQ(both.results()["clocks_apart_us"], 2000);
  EXPECT_DOUBLE_EQ(both.results()["clocks_apart_off_us"], 500);
}

TEST(BothEnds, CountForcesThatAreNotAsTheyWereSent) {
  BothEnds both;
  begin(both);
  play({.motion = 1}, both);
  play({.motion = 2, .force_at_client_N = 1.0000000000000002}, both);
  EXPECT_EQ(both.results()["forces"]["differ"], 1);
}

TEST(BothEnds, LeaveOutTheServersOtherClients) {
  BothEnds both;
  begin(both);
  play({.motion = 1}, both);
  record::SentForceRecord sent;
  sent.force.session = 7;
  sent.force.sequence = 1;
  both.add(sent);
  record::MotionRecord motion{};
  motion.motion.session = 7;
  motion.motion.sequence = 1;
  both.add(motion);
  EXPECT_EQ(both.results()["forces"]["sent"], 1);
  EXPECT_EQ(both.results()["motions"]["answered"], 1);
}

TEST(BothEnds, WithoutACommonSessionAreRefused) {
  BothEnds both;
  begin(both);
  play({.came_back = false}, both);
  EXPECT_THROW((void)both.results(), std::runtime_error);
}

}  // namespace
}  // namespace forcebound::client::commands
