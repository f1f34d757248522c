#include "forcebound/client/session/force_stream.hpp"

#include <gtest/gtest.h>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using Verdict = ForceStream::Verdict;

constexpr std::uint64_t kSession = 77;

class ForceStreamTest : public ::testing::Test {
 protected:
  ForceStreamTest() {
    stream.begin_session(kSession);
    for (int i = 1; i <= 10; ++i) stream.note_sent(i * 1ms);
  }

  static wire::EnvironmentForce answer(std::uint64_t sequence, std::uint64_t motion) {
    wire::EnvironmentForce force;
    force.session = kSession;
    force.sequence = sequence;
    force.motion_sequence = motion;
    force.motion_device_time = static_cast<int>(motion) * 1ms;
    force.force = control::Vector::Constant(1, -static_cast<double>(motion));
    force.position = control::Vector::Zero(1);
    force.motions_received = motion;
    return force;
  }

  ForceStream stream{1};
};

TEST_F(ForceStreamTest, ChoosesTheForceThatAnswersTheNewestMotion) {
  EXPECT_EQ(stream.accept(answer(1, 3)), Verdict::newest);
  EXPECT_EQ(stream.accept(answer(3, 7)), Verdict::newest);
  EXPECT_EQ(stream.accept(answer(2, 5)), Verdict::overtaken);
  EXPECT_EQ(stream.newest()->motion_sequence, 7U);
  EXPECT_EQ(stream.counts().received, 3U);
  EXPECT_EQ(stream.counts().overtaken, 1U);
}

TEST_F(ForceStreamTest, CountsOfMoreThanWasEverSentAreImplausible) {
  constexpr std::uint64_t kMost = ~std::uint64_t{0};
  auto heard_too_much = answer(1, 3);
  heard_too_much.motions_received = 11;
  EXPECT_EQ(stream.accept(heard_too_much), Verdict::implausible);
  EXPECT_EQ(stream.accept(answer(kMost, 3)), Verdict::implausible);
  EXPECT_EQ(stream.accept(answer(1, 3)), Verdict::newest);
  EXPECT_TRUE(stream.accept(wire::Bye{.session = kSession, .motions_received = kMost, .forces_sent = 1}));
  EXPECT_TRUE(stream.accept(wire::Bye{.session = kSession, .motions_received = 10, .forces_sent = kMost}));
  EXPECT_EQ(stream.counts().lost_up, 7U);
  EXPECT_EQ(stream.counts().lost_down, 0U);
  EXPECT_EQ(stream.counts().implausible, 4U);
}

TEST_F(ForceStreamTest, DropsCopies) {
  EXPECT_EQ(stream.accept(answer(1, 3)), Verdict::newest);
  EXPECT_EQ(stream.accept(answer(1, 3)), Verdict::duplicate);
  EXPECT_EQ(stream.counts().received, 1U);
  EXPECT_EQ(stream.counts().duplicated, 1U);
}

TEST_F(ForceStreamTest, DropsForcesOfAnotherSession) {
  auto force = answer(1, 3);
  force.session = kSession + 1;
  EXPECT_EQ(stream.accept(force), Verdict::foreign);
  EXPECT_FALSE(stream.newest());
}

TEST_F(ForceStreamTest, DropsWhatAnswersNothingThatWasSent) {
  EXPECT_EQ(stream.accept(answer(1, 0)), Verdict::implausible);
  EXPECT_EQ(stream.accept(answer(1, 11)), Verdict::implausible);
  auto wrong_time = answer(1, 3);
  wrong_time.motion_device_time += 1ns;
  EXPECT_EQ(stream.accept(wrong_time), Verdict::implausible);
  auto wrong_rows = answer(1, 3);
  wrong_rows.force = control::Vector::Zero(3);
  EXPECT_EQ(stream.accept(wrong_rows), Verdict::implausible);
  EXPECT_FALSE(stream.newest());
  EXPECT_EQ(stream.counts().implausible, 4U);
}

TEST_F(ForceStreamTest, DropsAnswersToMotionOlderThanItRemembers) {
  for (int i = 11; i <= 70'000; ++i) stream.note_sent(i * 1ms);
  EXPECT_EQ(stream.accept(answer(1, 3)), Verdict::implausible);
  EXPECT_EQ(stream.accept(answer(2, 69'999)), Verdict::newest);
}

TEST_F(ForceStreamTest, TellsWhichDirectionLost) {
  auto force = answer(4, 10);  // ten sent, eight arrived there, four forces sent of which this is the only one here
  force.motions_received = 8;
  force.motions_reordered = 3;
  ASSERT_EQ(stream.accept(force), Verdict::newest);
  const auto counts = stream.counts();
  EXPECT_EQ(counts.sent, 10U);
  EXPECT_EQ(counts.lost_up, 2U);
  EXPECT_EQ(counts.lost_down, 3U);
  EXPECT_EQ(counts.motions_overtaken, 3U);
}

TEST_F(ForceStreamTest, TakesTheServersLastWordWhateverItsOrder) {
  ASSERT_TRUE(stream.accept(wire::Bye{.session = kSession, .motions_received = 9, .forces_sent = 9}));
  stream.accept(answer(1, 3));
  EXPECT_EQ(stream.counts().lost_up, 1U);
  EXPECT_EQ(stream.counts().lost_down, 8U);
  EXPECT_FALSE(stream.accept(wire::Bye{.session = kSession + 1, .motions_received = 10}));
}

TEST_F(ForceStreamTest, KeepsCountingOverSessions) {
  auto force = answer(1, 10);
  force.motions_received = 9;
  stream.accept(force);
  stream.begin_session(kSession + 1);
  EXPECT_EQ(stream.counts().lost_up, 1U);
  EXPECT_EQ(stream.note_sent(11ms), 11U) << "motions keep their numbers";
  EXPECT_EQ(stream.newest()->motion_sequence, 10U) << "the force fades by its age, it does not jump";
  auto next = answer(1, 11);
  next.session = kSession + 1;
  next.motions_received = 1;
  EXPECT_EQ(stream.accept(next), Verdict::newest) << "a new session's forces are numbered from 1 again";
  EXPECT_EQ(stream.counts().sent, 11U);
  EXPECT_EQ(stream.counts().received, 2U);
  EXPECT_EQ(stream.counts().lost_up, 1U);
}

}  // namespace
}  // namespace forcebound::client
