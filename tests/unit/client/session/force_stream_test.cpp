#include "forcebound/client/session/force_stream.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using Verdict = ForceStream::Verdict;

constexpr std::uint64_t kStreamSession = 77;

class ForceStreamTest : public ::testing::Test {
 protected:
  ForceStreamTest() {
    stream.begin_session(kStreamSession);
    for (int i = 1; i <= 10; ++i) stream.count_sent(i * 1ms);
  }

  static wire::EnvironmentForce answer(std::uint64_t sequence, std::uint64_t motion) {
    wire::EnvironmentForce force;
    force.session = kStreamSession;
    force.sequence = sequence;
    force.motion_sequence = motion;
    force.motion_device_time = static_cast<int>(motion) * 1ms;
    force.answer.force = control::Vector::Constant(1, -static_cast<double>(motion));
    force.position = control::Vector::Zero(1);
    force.motions_received = motion;
    return force;
  }

  /// It arrives a millisecond after the newest motion was sent.
  Verdict accept(const wire::EnvironmentForce& force) { return stream.accept(force, now + 1ms); }
  ForceStream::Counts counts() { return stream.counts(now); }

  Nanoseconds now = 10ms;
  ForceStream stream{1};
};

TEST_F(ForceStreamTest, ChoosesTheForceThatAnswersTheNewestMotion) {
  EXPECT_EQ(accept(answer(1, 3)), Verdict::newest);
  EXPECT_EQ(accept(answer(3, 7)), Verdict::newest);
  EXPECT_EQ(accept(answer(2, 5)), Verdict::reordered);
  EXPECT_EQ(stream.newest()->motion_sequence, 7U);
  EXPECT_EQ(counts().received, 3U);
  EXPECT_EQ(counts().reordered, 1U);
}

TEST_F(ForceStreamTest, CountsAboveTheMotionsSentAreImplausible) {
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  auto heard_too_much = answer(1, 3);
  heard_too_much.motions_received = 11;
  EXPECT_EQ(accept(heard_too_much), Verdict::implausible);
  EXPECT_EQ(accept(answer(kMost, 3)), Verdict::implausible);
  EXPECT_EQ(accept(answer(1, 3)), Verdict::newest);
  EXPECT_TRUE(stream.accept(wire::Bye{.session = kStreamSession, .motions_received = kMost, .forces_sent = 1}));
  EXPECT_TRUE(stream.accept(wire::Bye{.session = kStreamSession, .motions_received = 10, .forces_sent = kMost}));
  EXPECT_EQ(counts().lost_up, 7U);
  EXPECT_EQ(counts().lost_down, 0U);
  EXPECT_EQ(counts().implausible, 4U);
}

TEST_F(ForceStreamTest, AForceIsNumberedNoHigherThanTheMotionItAnswers) {
  for (int i = 11; i <= 40'000; ++i) stream.count_sent(i * 1ms);
  auto far_ahead = answer(39'000, 10);
  far_ahead.motions_received = 39'000;
  EXPECT_EQ(accept(far_ahead), Verdict::implausible);
  EXPECT_EQ(accept(answer(1, 10)), Verdict::newest) << "its number has not become old";
}

TEST_F(ForceStreamTest, DropsCopies) {
  EXPECT_EQ(accept(answer(1, 3)), Verdict::newest);
  EXPECT_EQ(accept(answer(1, 3)), Verdict::duplicate);
  EXPECT_EQ(counts().received, 1U);
  EXPECT_EQ(counts().duplicated, 1U);
}

TEST_F(ForceStreamTest, DropsForcesOfAnotherSession) {
  auto force = answer(1, 3);
  force.session = kStreamSession + 1;
  EXPECT_EQ(accept(force), Verdict::foreign);
  EXPECT_FALSE(stream.newest());
}

TEST_F(ForceStreamTest, DropsForcesThatAnswerNoMotionSent) {
  EXPECT_EQ(accept(answer(1, 0)), Verdict::implausible);
  EXPECT_EQ(accept(answer(1, 11)), Verdict::implausible);
  auto wrong_time = answer(1, 3);
  wrong_time.motion_device_time += 1ns;
  EXPECT_EQ(accept(wrong_time), Verdict::implausible);
  auto wrong_rows = answer(1, 3);
  wrong_rows.answer.force = control::Vector::Zero(3);
  EXPECT_EQ(accept(wrong_rows), Verdict::implausible);
  EXPECT_FALSE(stream.newest());
  EXPECT_EQ(counts().implausible, 4U);
}

TEST_F(ForceStreamTest, AcceptsAPenetrationUpToThePositionsDistance) {
  auto far_behind_a_wall = answer(1, 3);
  far_behind_a_wall.position[0] = 30e3;
  far_behind_a_wall.answer.contact_normal = control::Vector::Constant(1, -1.0);
  far_behind_a_wall.answer.penetration_m = 30e3;
  EXPECT_EQ(accept(far_behind_a_wall), Verdict::newest);
  auto deeper_than_it_can_be = answer(2, 4);
  deeper_than_it_can_be.answer.contact_normal = control::Vector::Constant(1, -1.0);
  deeper_than_it_can_be.answer.penetration_m = 30e3;
  EXPECT_EQ(accept(deeper_than_it_can_be), Verdict::implausible);
}

TEST_F(ForceStreamTest, DropsAnswersToMotionOlderThanItRemembers) {
  for (int i = 11; i <= 70'000; ++i) stream.count_sent(i * 1ms);
  EXPECT_EQ(accept(answer(1, 3)), Verdict::implausible);
  EXPECT_EQ(accept(answer(2, 69'999)), Verdict::newest);
}

TEST_F(ForceStreamTest, CountsLossesByDirection) {
  auto force = answer(4, 10);  // 10 motions sent, 8 received by the server, 4 forces sent, 1 received
  force.motions_received = 8;
  force.motions_reordered = 3;
  ASSERT_EQ(accept(force), Verdict::newest);
  const auto told = counts();
  EXPECT_EQ(told.sent, 10U);
  EXPECT_EQ(told.lost_up, 2U);
  EXPECT_EQ(told.lost_down, 3U);
  EXPECT_EQ(told.motions_reordered, 3U);
}

TEST_F(ForceStreamTest, TakesTheServersFinalCountsInAnyOrder) {
  ASSERT_TRUE(stream.accept(wire::Bye{.session = kStreamSession, .motions_received = 9, .forces_sent = 9}));
  accept(answer(1, 3));
  EXPECT_EQ(counts().lost_up, 1U);
  EXPECT_EQ(counts().lost_down, 8U);
  EXPECT_FALSE(stream.accept(wire::Bye{.session = kStreamSession + 1, .motions_received = 10}));
}

TEST_F(ForceStreamTest, AServerThatAnsweredMoreThanItReceivedIsImplausible) {
  auto force = answer(3, 5);
  force.motions_received = 2;
  EXPECT_EQ(accept(force), Verdict::implausible);
  EXPECT_EQ(accept(answer(0, 5)), Verdict::implausible) << "its forces count from one";
  EXPECT_TRUE(stream.accept(wire::Bye{.session = kStreamSession, .motions_received = 2, .forces_sent = 3}));
  EXPECT_EQ(counts().implausible, 3U);
  EXPECT_EQ(counts().lost_up, 10U);
}

TEST_F(ForceStreamTest, CountsEachMotionOnce) {
  // Of ten motions the fourth was lost, the third came after the fifth, and the answer to the second was lost: the
  // server has received six of the first seven and sent five answers. The seventh took longest: 4 ms.
  for (const auto& [sequence, motion, received, arrival_ms] :
       {std::tuple{1, 1, 1, 2}, {3, 5, 3, 6}, {4, 6, 5, 8}, {5, 7, 6, 11}}) {
    auto force = answer(static_cast<std::uint64_t>(sequence), static_cast<std::uint64_t>(motion));
    force.motions_received = static_cast<std::uint64_t>(received);
    ASSERT_EQ(stream.accept(force, arrival_ms * 1ms), Verdict::newest);
  }
  const auto told = stream.counts(11ms);
  EXPECT_EQ(told.sent, 10U);
  EXPECT_EQ(told.received, 4U);
  EXPECT_EQ(told.unanswered, 1U);
  EXPECT_EQ(told.lost_down, 1U);
  EXPECT_EQ(told.in_flight, 3U) << "the eighth to the tenth";
  EXPECT_EQ(told.lost_up, 1U + told.in_flight);
  EXPECT_EQ(stream.counts(13ms).in_flight, 2U) << "of the ninth and tenth an answer may still come";
  EXPECT_EQ(stream.counts(15ms).in_flight, 0U);
  EXPECT_EQ(stream.counts(15ms).lost_up, 4U);
}

TEST_F(ForceStreamTest, AMotionThatWasNeverSentIsNotInFlight) {
  ASSERT_EQ(accept(answer(1, 5)), Verdict::newest);
  stream.count_sent(11ms);
  stream.uncount_sent();
  stream.count_sent(12ms);
  const auto told = stream.counts(12ms);
  EXPECT_EQ(told.sent, 11U);
  EXPECT_EQ(told.in_flight, 6U);
}

TEST_F(ForceStreamTest, NothingIsInFlightWhereNoAnswerEverCame) {
  EXPECT_EQ(stream.counts(11ms).in_flight, 0U);
  EXPECT_EQ(stream.counts(11ms).lost_up, 10U);
}

TEST_F(ForceStreamTest, LongestDelayIsTheRoundTripPlusTheLateness) {
  ASSERT_EQ(stream.accept(answer(1, 3), 7ms), Verdict::newest);
  ASSERT_EQ(stream.accept(answer(2, 4), 6ms), Verdict::newest);
  EXPECT_EQ(stream.longest_delay(), 4ms);
  ASSERT_TRUE(stream.accept(
      wire::Bye{.session = kStreamSession, .motions_received = 4, .forces_sent = 2, .motions_behind = 3}));
  EXPECT_EQ(stream.longest_delay(), 7ms);
  ASSERT_TRUE(stream.accept(
      wire::Bye{.session = kStreamSession, .motions_received = 4, .forces_sent = 2, .motions_behind = 11}));
  EXPECT_EQ(stream.longest_delay(), 7ms) << "no motion can be behind so many";
  EXPECT_EQ(counts().implausible, 1U);
}

TEST_F(ForceStreamTest, LatenessIsTheLongestTimeInWhichSoManyMotionsWereSent) {
  stream.count_sent(15ms);
  stream.count_sent(40ms);
  stream.count_sent(41ms);
  const auto bye = [](std::uint64_t behind) {
    return wire::Bye{.session = kStreamSession, .motions_received = 4, .forces_sent = 2, .motions_behind = behind};
  };
  ASSERT_TRUE(stream.accept(bye(2)));
  EXPECT_EQ(stream.longest_delay(), 30ms) << "from the tenth, at 10 ms, to the twelfth";
  ASSERT_TRUE(stream.accept(bye(1)));
  EXPECT_EQ(stream.longest_delay(), 30ms);
  stream.begin_session(kStreamSession + 1);
  stream.count_sent(42ms);
  stream.count_sent(44ms);
  auto next = bye(1);
  next.session = kStreamSession + 1;
  next.motions_received = 2;
  ASSERT_TRUE(stream.accept(next));
  EXPECT_EQ(stream.longest_delay(), 2ms) << "of this session alone";
  next.motions_behind = 2;
  ASSERT_TRUE(stream.accept(next));
  EXPECT_EQ(stream.longest_delay(), 2ms) << "of two motions none can be two behind";
  EXPECT_EQ(counts().implausible, 1U);
}

TEST_F(ForceStreamTest, KeepsCountingOverSessions) {
  auto force = answer(1, 10);
  force.motions_received = 9;
  accept(force);
  stream.begin_session(kStreamSession + 1);
  EXPECT_EQ(counts().lost_up, 1U);
  EXPECT_EQ(stream.count_sent(11ms), 11U) << "motions keep their numbers";
  EXPECT_EQ(stream.newest()->motion_sequence, 10U) << "the force fades by its age, it does not jump";
  auto next = answer(1, 11);
  next.session = kStreamSession + 1;
  next.motions_received = 1;
  EXPECT_EQ(accept(next), Verdict::newest) << "a new session's forces are numbered from 1 again";
  EXPECT_EQ(counts().sent, 11U);
  EXPECT_EQ(counts().received, 2U);
  EXPECT_EQ(counts().lost_up, 1U);
}

}  // namespace
}  // namespace forcebound::client
