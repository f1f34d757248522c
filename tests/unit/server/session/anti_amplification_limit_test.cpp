#include "forcebound/server/session/anti_amplification_limit.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

TEST(AntiAmplificationLimit, SendsNoMoreThanCameUntilTheAddressIsProven) {
  AntiAmplificationLimit limit;
  limit.begin(7);
  EXPECT_FALSE(limit.spend(1));
  limit.count_received(50, 0);
  EXPECT_FALSE(limit.spend(120));
  limit.count_received(50, 8);
  limit.count_received(50, 0);
  EXPECT_TRUE(limit.spend(120));
  EXPECT_FALSE(limit.spend(31)) << "30 are left";
  EXPECT_FALSE(limit.proven());
  limit.count_received(50, 7);
  EXPECT_TRUE(limit.proven());
  EXPECT_TRUE(limit.spend(1'000'000));
}

TEST(AntiAmplificationLimit, AChallengeCountsOnceAndForItsAddressAlone) {
  AntiAmplificationLimit limit;
  limit.begin(7);
  limit.begin(9);
  limit.count_received(50, 7);
  EXPECT_FALSE(limit.proven());
  limit.count_received(50, 9);
  EXPECT_EQ(limit.challenge(), 0U);
  limit.begin(11);
  EXPECT_FALSE(limit.spend(1)) << "what came from the address before does not count";
}

TEST(AntiAmplificationLimit, WithoutAChallengeNothingProvesAnAddress) {
  AntiAmplificationLimit limit;
  limit.begin(0);
  limit.count_received(50, 0);
  EXPECT_FALSE(limit.proven());
}

}  // namespace
}  // namespace forcebound::server
