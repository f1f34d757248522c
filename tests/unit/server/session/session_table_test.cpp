#include "forcebound/server/session/session_table.hpp"

#include "tests/unit/server/session/parts_fixture.hpp"

namespace forcebound::server {
namespace {

class SessionTableTest : public PartsFixture {};

TEST_F(SessionTableTest, FindsASessionByItsNumberAndByAddressAndNonce) {
  const Session& one = open(1);
  const Session& two = open(2);
  EXPECT_EQ(table.find(1), &one);
  EXPECT_EQ(table.find(address(2), 2), &two);
  EXPECT_EQ(table.find(address(1), 2), nullptr);
  EXPECT_EQ(table.find(3), nullptr);
  EXPECT_EQ(counters.sessions_opened, 2U);
}

TEST_F(SessionTableTest, RemembersASessionThatItsClientEnded) {
  (void)open(5);
  table.close_by_client({.session = 5}, 0, address(5));
  EXPECT_EQ(table.find(5), nullptr);
  EXPECT_TRUE(table.has_or_had(5));
  EXPECT_TRUE(table.has_ended(address(5), 5));
  EXPECT_FALSE(table.has_ended(address(6), 5));
  EXPECT_EQ(counters.sessions_ended, 1U);
}

TEST_F(SessionTableTest, AnswersByeAgainIfItsAnswerWasLost) {
  open(1).arrivals.counts.motions_received = 1;
  table.close_by_client({.session = 1}, 0, address(1));
  EXPECT_EQ(only_sent<wire::Bye>().motions_received, 1U);
  table.close_by_client({.session = 1}, 0, address(1));
  EXPECT_EQ(only_sent<wire::Bye>().motions_received, 1U);
  EXPECT_EQ(counters.byes_repeated, 1U);
}

TEST_F(SessionTableTest, AnswersAByeFromElsewhereWithNoMoreThanItSent) {
  open(1).arrivals.counts.motions_received = 1;
  table.close_by_client({.session = 1}, 8, address(66));
  EXPECT_TRUE(link.sent.empty());
  table.close_by_client({.session = 1}, 1000, address(66));
  EXPECT_EQ(only_sent<wire::Bye>().session, 1U);
}

TEST_F(SessionTableTest, IgnoresByeOfASessionItNeverHad) {
  table.close_by_client({.session = 4711}, 1000, address(1));
  table.close_by_client({}, 1000, address(1));
  EXPECT_TRUE(link.sent.empty());
  EXPECT_EQ(counters.byes_unknown, 2U);
}

TEST_F(SessionTableTest, ClosesEachThatThereIsAReasonToClose) {
  (void)open(1, "anna's key");
  (void)open(2, "bert's key");
  (void)open(3, "anna's key");
  EXPECT_EQ(table.close_each([](const Session& session) {
    return session.client == "anna's key" ? std::optional(CloseReason::was_asked_to) : std::nullopt;
  }),
            2U);
  EXPECT_EQ(table.size(), 1U);
  EXPECT_NE(table.find(2), nullptr);
  EXPECT_EQ(link.sent.size(), 2U) << "a Bye for each";
  EXPECT_EQ(counters.sessions_removed, 2U);
}

}  // namespace
}  // namespace forcebound::server
