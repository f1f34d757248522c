#include "forcebound/server/session/capacity.hpp"

#include "tests/unit/server/session/parts_fixture.hpp"

namespace forcebound::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CapacityTest : public PartsFixture {
 protected:
  Session& open_counted(std::uint64_t number, const std::string& client = {}) {
    Session& session = open(number, client);
    capacity.count_opened();
    return session;
  }

  /// Why there is no room; empty: there is.
  std::string refusal(const ClientRights& rights = {}) {
    const auto refused = capacity.refusal_of(*kind, {.address = address(99), .rights = rights}, clock.time);
    return refused ? refused->text : "";
  }

  Housekeeping housekeeping{options, table};
  Capacity capacity{options, table, housekeeping, counters};
};

TEST_F(CapacityTest, OneAddressGetsNoMoreSessionsThanAllowed) {
  options.sessions_per_address = 2;
  (void)open_counted(1);
  EXPECT_EQ(refusal(), "");
  (void)open_counted(2);
  EXPECT_THAT(refusal(), HasSubstr("takes 2 sessions at once"));
  EXPECT_FALSE(capacity.refusal_of(*kind, {.address = {.ip = {0x20}, .port = 1}}, clock.time)) << "another address";
}

TEST_F(CapacityTest, EvictsAClientsOwnSessionThatDoesNothingForAnother) {
  const ClientRights one{.name = "anna", .key = "anna's key", .sessions_max = 1};
  open_counted(1, "anna's key").arrivals.counts.motions_received = 1;
  (void)open_counted(2, "bert's key");
  EXPECT_EQ(refusal(one), "client 'anna' has as many sessions as it may, 1: end one or try again later");
  clock.time = options.presence_timeout + milliseconds{1};
  EXPECT_EQ(refusal(one), "");
  EXPECT_EQ(table.find(1), nullptr);
  EXPECT_NE(table.find(2), nullptr);
}

TEST_F(CapacityTest, ExpectsOfOneMoreWhatTheOthersTakeOnAverage) {
  for (std::uint64_t number = 1; number <= 4; ++number) (void)open_counted(number);
  capacity.store_busy(0, 0);
  counters.motions_received = 4000;
  capacity.store_busy(0.7, 4000);
  EXPECT_EQ(refusal(), "") << "0.7 of four, and a quarter of it more";
  counters.motions_received = 8000;
  capacity.store_busy(0.8, 4000);
  EXPECT_THAT(refusal(),
              AllOf(HasSubstr("this server is busy"), HasSubstr("one more would take 20 %, of 90 % at most")));
}

TEST_F(CapacityTest, WhatManyTookWhoHaveLeftIsNotExpectedOfEachWhoComes) {
  for (std::uint64_t number = 1; number <= 20; ++number) (void)open_counted(number);
  counters.motions_received = 20;
  capacity.store_busy(0.6, 20);
  table.close_each([](const Session& session) {
    return session.nonce == 1 ? std::nullopt : std::optional(CloseReason::was_asked_to);
  });
  EXPECT_EQ(refusal(), "") << "not 60 % more";
}

TEST_F(CapacityTest, AFloodKeepsNobodyOut) {
  (void)open_counted(1);
  counters.motions_received = 1000;
  capacity.store_busy(1, 100'000);
  EXPECT_EQ(refusal(), "");
  EXPECT_NEAR(capacity.busy(), 0.01, 1e-12) << "a hundredth of the datagrams were motions of sessions";
}

}  // namespace
}  // namespace forcebound::server
