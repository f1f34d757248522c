#include "forcebound/server/session/answerer.hpp"

#include "tests/unit/server/session/parts_fixture.hpp"

namespace forcebound::server {
namespace {

class AnswererTest : public PartsFixture {
 protected:
  void receive(std::uint64_t session, std::uint64_t sequence) {
    const wire::MotionSample motion{.session = session, .sequence = sequence, .position = vector_of({0.001})};
    answerer.receive(motion, 1000, address(static_cast<std::uint16_t>(session)), clock.time);
  }

  std::function<std::uint64_t()> random = [] { return std::uint64_t{77}; };
  Answerer answerer{options, {table, replies, counters, diary, clock, random}};
};

TEST_F(AnswererTest, AnswersTheNewestOfTheMotionsThatCameWhileItWasBusy) {
  (void)open(1);
  (void)open(2);
  for (std::uint64_t sequence = 1; sequence <= 5; ++sequence) receive(1, sequence);
  receive(2, 1);
  EXPECT_TRUE(link.sent.empty());
  EXPECT_TRUE(answerer.answer_next());
  const auto first = only_sent<wire::EnvironmentForce>();
  EXPECT_EQ(first.motion_sequence, 5U);
  EXPECT_EQ(first.motions_received, 5U);
  EXPECT_EQ(first.answer.force, vector_of({1}));
  EXPECT_TRUE(answerer.answer_next());
  EXPECT_EQ(only_sent<wire::EnvironmentForce>().session, 2U);
  EXPECT_EQ(counters.motions_superseded, 4U);
  EXPECT_FALSE(answerer.answer_next());
}

TEST_F(AnswererTest, AMotionWhoseSessionEndedWhileItWaitedIsNotAnswered) {
  Session& session = open(1);
  receive(1, 1);
  table.close(session, CloseReason::idle);
  link.sent.clear();
  EXPECT_FALSE(answerer.answer_next());
  EXPECT_TRUE(link.sent.empty());
  EXPECT_EQ(counters.motions_after_end, 1U);
}

TEST_F(AnswererTest, StaysBoundedThoughAClientOpensAndEndsManySessionsBetweenTwoAnswers) {
  for (std::uint64_t number = 1; number <= 4 * options.sessions_max; ++number) {
    Session& session = open(number);
    receive(number, 1);
    if (number > 1) table.close(session, CloseReason::was_asked_to);
  }
  EXPECT_EQ(counters.forces_sent, 1U) << "the first session's, as there was no room for more";
  EXPECT_EQ(diary.forces, 1);
}

TEST_F(AnswererTest, RefusesMotionsOfUnknownSessionsWithinWhatTheySentAndARate) {
  answerer.refuse(4711, 1000, address(3), clock.time);
  EXPECT_EQ(only_sent<wire::Refusal>().session, 4711U);
  answerer.refuse(4711, 8, address(3), clock.time);
  EXPECT_TRUE(link.sent.empty()) << "it would be more than came";
  for (int i = 0; i < 200; ++i) answerer.refuse(4711, 1000, address(3), clock.time);
  EXPECT_EQ(link.sent.size(), 98U) << "100 at once, and two are gone";
  EXPECT_EQ(counters.motions_without_session, 202U);
}

}  // namespace
}  // namespace forcebound::server
