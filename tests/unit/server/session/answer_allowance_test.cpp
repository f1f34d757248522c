#include "forcebound/server/session/answer_allowance.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

TEST(AnswerAllowance, SendsNoMoreThanCameUntilTheAddressIsProven) {
  AnswerAllowance allowance;
  allowance.begin(7);
  EXPECT_FALSE(allowance.spend(1));
  allowance.take_in(50, 0);
  EXPECT_FALSE(allowance.spend(120));
  allowance.take_in(50, 8);
  allowance.take_in(50, 0);
  EXPECT_TRUE(allowance.spend(120));
  EXPECT_FALSE(allowance.spend(31)) << "30 are left";
  EXPECT_FALSE(allowance.proven());
  allowance.take_in(50, 7);
  EXPECT_TRUE(allowance.proven());
  EXPECT_TRUE(allowance.spend(1'000'000));
}

TEST(AnswerAllowance, AChallengeCountsOnceAndForItsAddressAlone) {
  AnswerAllowance allowance;
  allowance.begin(7);
  allowance.begin(9);
  allowance.take_in(50, 7);
  EXPECT_FALSE(allowance.proven());
  allowance.take_in(50, 9);
  EXPECT_EQ(allowance.challenge(), 0U);
  allowance.begin(11);
  EXPECT_FALSE(allowance.spend(1)) << "what came from the address before does not count";
}

TEST(AnswerAllowance, WithoutAChallengeNothingProvesAnAddress) {
  AnswerAllowance allowance;
  allowance.begin(0);
  allowance.take_in(50, 0);
  EXPECT_FALSE(allowance.proven());
}

}  // namespace
}  // namespace forcebound::server
