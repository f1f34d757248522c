#include "forcebound/server/session/replies.hpp"

#include "tests/unit/server/session/parts_fixture.hpp"

namespace forcebound::server {
namespace {

class RepliesTest : public PartsFixture {};

TEST_F(RepliesTest, CountWhatTheLinkDoesNotTake) {
  link.works = false;
  EXPECT_FALSE(replies.send(wire::Bye{.session = 1}, address(1)));
  EXPECT_EQ(counters.sends_failed, 1U);
}

TEST_F(RepliesTest, TellTheObserverOfASessionOnceAndItsClientAsOftenAsItAsks) {
  const Session& session = open(1);
  replies.welcome(session, false);
  replies.welcome(session, true);
  EXPECT_EQ(link.sent.size(), 2U);
  EXPECT_THAT(diary.lines, testing::ElementsAre("opened stick in newton"));
}

TEST_F(RepliesTest, RefuseWithTheReasonForBothAndCountIt) {
  replies.refuse({.client_nonce = 9}, address(1), {wire::RefusalReason::server_full, "try again later"});
  const auto refusal = only_sent<wire::Refusal>();
  EXPECT_EQ(refusal.client_nonce, 9U);
  EXPECT_EQ(refusal.text, "try again later");
  EXPECT_THAT(diary.lines, testing::ElementsAre("refused try again later"));
  EXPECT_EQ(counters.hellos_refused, 1U);
}

}  // namespace
}  // namespace forcebound::server
