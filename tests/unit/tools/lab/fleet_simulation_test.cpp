#include "tests/tools/lab/fleet/fleet_simulation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

/// A fleet that is never short of servers, and in which nothing fails.
FleetSettings ample() {
  FleetSettings settings;
  settings.clients = 20'000;
  settings.arrive_s = 1000;
  settings.stay_s = 100;
  settings.spares = 50;
  settings.failures_s = {};
  return settings;
}

TEST(AFleet, GivesEachClientASessionAndLosesNone) {
  const FleetResult result = simulate_fleet(ample());
  EXPECT_EQ(result.arrived, 20'000U);
  EXPECT_EQ(result.left, 20'000U);
  EXPECT_EQ(result.waits_s.size(), 20'000U);
  EXPECT_EQ(result.refused, 0U);
  EXPECT_EQ(result.failed_over, 0U);
  EXPECT_LE(result.sessions_of_server_most, 64U);
}

// Little's law: sessions on average = arrivals per second times the mean stay.
TEST(AFleet, HasAsManySessionsAsLittlesLawSays) {
  const FleetResult result = simulate_fleet(ample());
  const double expected = 20'000 / 1000.0 * 100;
  // The standard deviation of one second is sqrt(2000) = 45; 500 s are five independent stays.
  EXPECT_NEAR(result.sessions_mean, expected, 4 * std::sqrt(expected / 5));
}

// Each client changes its address at random, independent of its stay: stays times the mean stay over the mean time.
TEST(AFleet, RoamsAsOftenAsItIsSaid) {
  FleetSettings settings = ample();
  settings.roam_s = 50;
  const double expected = 20'000 * 100 / 50.0;
  // The number of one client is geometric with mean 2 and variance 6.
  EXPECT_NEAR(static_cast<double>(simulate_fleet(settings).roamed), expected, 4 * std::sqrt(20'000 * 6.0));
  settings.roam_s = 0;
  EXPECT_EQ(simulate_fleet(settings).roamed, 0U);
}

TEST(AFleet, IsTheSameFromTheSameSeedAndAnotherFromAnother) {
  FleetSettings settings = ample();
  settings.clients = 1000;
  const std::string one = fleet_csv(simulate_fleet(settings));
  EXPECT_EQ(one, fleet_csv(simulate_fleet(settings)));
  settings.seed = 2;
  EXPECT_NE(one, fleet_csv(simulate_fleet(settings)));
}

TEST(AFleet, BringsTheClientsOfANodeBackAndNobodyElse) {
  FleetSettings settings = ample();
  settings.failures_s = {500};
  const FleetResult result = simulate_fleet(settings);
  EXPECT_GT(result.failed_over, 100U);
  EXPECT_LE(result.failed_over, 16U * 64U);
  EXPECT_EQ(result.back + result.left_meanwhile, result.failed_over);
  EXPECT_EQ(result.outages_s.size(), result.back);
  EXPECT_EQ(result.left + result.left_meanwhile, 20'000U);
  EXPECT_GE(result.outages_s.front(), settings.notice_s);
  // All want a server within a twentieth of a second, and the allocator takes its time for each.
  EXPECT_GE(result.outages_s.back(), settings.notice_s + settings.allocate_s * static_cast<double>(result.back));
}

// New servers are there a look and a start after they are missed. Those spares that do not outlast this let clients
// wait.
TEST(AFleet, LetsClientsWaitWhereItsSparesDoNotLastUntilNewServersStart) {
  FleetSettings settings = ample();
  settings.clients = 10'000;
  settings.arrive_s = 200;
  settings.stay_s = 1e5;
  settings.places = 8;
  settings.servers_most = 10'000;
  const double taken_each_s = 50.0 / 8;
  const double needed = taken_each_s * (settings.look_s + settings.start_s);
  settings.spares = static_cast<std::size_t>(needed * 1.5);
  EXPECT_EQ(simulate_fleet(settings).refused, 0U);
  settings.spares = static_cast<std::size_t>(needed / 3);
  const FleetResult few = simulate_fleet(settings);
  EXPECT_GT(few.refused, 0U);
  EXPECT_GT(at_share(few.waits_s, 0.99), settings.retry_s);
}

TEST(AFleet, NeverHasMoreServersOrSessionsThanItMay) {
  FleetSettings settings = ample();
  settings.servers_most = 10;
  settings.spares = 2;
  settings.places = 16;
  const FleetResult result = simulate_fleet(settings);
  EXPECT_LE(result.servers_most, 10U);
  EXPECT_LE(result.sessions_most, 160U);
  EXPECT_EQ(result.sessions_of_server_most, 16U);
  EXPECT_EQ(result.left, 20'000U) << "all have their turn";
}

TEST(AFleet, MakesTheLastOfAllAtOnceWaitForAllHandshakesUnlessClientsSpreadThem) {
  FleetSettings settings = ample();
  settings.failures_s = {500};
  // The allocator paces nobody.
  settings.allocate_s = 1e-7;
  const auto longest = [&](double spread_s) {
    settings.spread_s = spread_s;
    return simulate_fleet(settings).handshakes_s.back();
  };
  const double all_s = 64 * settings.handshake_s;
  EXPECT_GT(longest(0), all_s);
  EXPECT_LT(longest(0), all_s / (1 - 64 * 1000 * settings.motion_s)) << "each takes longer beside motions";
  EXPECT_LT(longest(10), all_s / 5);
}

TEST(AFleet, IsRefusedWithTheReason) {
  const auto why_not = [](const FleetSettings& settings) -> std::string {
    try {
      (void)simulate_fleet(settings);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  FleetSettings settings = ample();
  settings.spares = 0;
  EXPECT_THAT(why_not(settings), HasSubstr("spares must be from 1"));
  settings = ample();
  settings.places = 140;
  EXPECT_THAT(why_not(settings), HasSubstr("140 places make 1"));
  settings = ample();
  settings.arrive_s = 0;
  EXPECT_THAT(why_not(settings), HasSubstr("above 0"));
}

TEST(MeanWait, IsThatOfPollaczekAndKhinchine) {
  EXPECT_DOUBLE_EQ(mean_wait_s(0, 1e-5), 0);
  EXPECT_DOUBLE_EQ(mean_wait_s(0.5, 1e-5), 0.5e-5);
  EXPECT_DOUBLE_EQ(mean_wait_s(0.9, 1e-5), 4.5e-5);
  EXPECT_THROW((void)mean_wait_s(1, 1e-5), std::invalid_argument);
}

TEST(AtShare, IsTheNearestRank) {
  const std::vector<double> values{1, 2, 3, 4};
  EXPECT_EQ(at_share(values, 0.5), 2);
  EXPECT_EQ(at_share(values, 0.51), 3);
  EXPECT_EQ(at_share(values, 1), 4);
  EXPECT_EQ(at_share(values, 0), 1);
  EXPECT_TRUE(std::isnan(at_share({}, 0.5)));
}

}  // namespace
}  // namespace forcebound::lab
