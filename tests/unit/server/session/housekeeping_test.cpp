#include "forcebound/server/session/housekeeping.hpp"

#include "tests/unit/server/session/parts_fixture.hpp"

namespace forcebound::server {
namespace {

class HousekeepingTest : public PartsFixture {
 protected:
  Session& open_moving(std::uint64_t number) {
    Session& session = open(number);
    session.arrivals.counts.motions_received = 1;
    return session;
  }

  Housekeeping housekeeping{options, table};
};

TEST_F(HousekeepingTest, ClosesIdleSessionsAndSaysByeToThoseWhoHaveSentMotion) {
  (void)open_moving(1);
  (void)open(2);  // never sends motion, so its address may be forged
  clock.time = options.idle_timeout - milliseconds{1};
  housekeeping.on_timer(clock.time);
  EXPECT_EQ(table.size(), 2U);
  (void)open(3);
  clock.time += milliseconds{1};
  housekeeping.on_timer(clock.time);
  EXPECT_EQ(table.size(), 1U);
  EXPECT_EQ(only_sent<wire::Bye>().session, 1U);
  EXPECT_EQ(counters.sessions_idle, 2U);
}

TEST_F(HousekeepingTest, EvictsNobodyWhoMayStillSendMotion) {
  (void)open(1);
  clock.time = seconds{1};
  EXPECT_FALSE(housekeeping.evict_one(clock.time, {}));
  clock.time += milliseconds{1};
  EXPECT_TRUE(housekeeping.evict_one(clock.time, {}));
  EXPECT_EQ(counters.sessions_idle, 1U);
}

TEST_F(HousekeepingTest, EvictsWhoIsSilentForLongestWherePlacesAreFew) {
  open_moving(1).last_received = seconds{5};
  open_moving(2).last_received = seconds{3};
  open_moving(3).last_received = seconds{4};
  clock.time = seconds{30};
  EXPECT_FALSE(housekeeping.evict_one(clock.time, {})) << "they have sent motion";
  EXPECT_TRUE(housekeeping.evict_one(clock.time, [](const Session& session) { return session.nonce != 2; }));
  EXPECT_EQ(only_sent<wire::Bye>().session, 3U);
}

TEST_F(HousekeepingTest, EvictsADeviceThatDoesNotMoveAndCountsItAsThat) {
  Session& session = open_moving(1);
  clock.time = options.stillness_timeout + milliseconds{1};
  session.last_received = clock.time;
  EXPECT_TRUE(housekeeping.evict_one(clock.time, [](const Session&) { return true; }));
  EXPECT_EQ(counters.sessions_still, 1U);
  EXPECT_EQ(counters.sessions_idle, 0U);
}

}  // namespace
}  // namespace forcebound::server
