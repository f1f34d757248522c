#include "forcebound/client/session/late_force_policy.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

TEST(LateForcePolicy, HoldsThenFadesLinearlyThenDrops) {
  const LateForcePolicy policy{.hold = 200ms, .drop = 1000ms};
  EXPECT_EQ(policy.scale(0ms), 1.0);
  EXPECT_EQ(policy.scale(200ms), 1.0);
  EXPECT_DOUBLE_EQ(policy.scale(600ms), 0.5);
  EXPECT_EQ(policy.scale(1000ms), 0.0);
  EXPECT_EQ(policy.scale(10h), 0.0);
}

TEST(LateForcePolicy, VerdictMatchesTheScale) {
  const LateForcePolicy policy{.hold = 200ms, .drop = 1000ms};
  EXPECT_EQ(policy.verdict(200ms), ForcePolicy::fresh);
  EXPECT_EQ(policy.verdict(201ms), ForcePolicy::fading);
  EXPECT_EQ(policy.verdict(1000ms), ForcePolicy::dropped);
}

TEST(LateForcePolicy, DropsAtOnceWhereHoldEqualsDrop) {
  const LateForcePolicy policy{.hold = 100ms, .drop = 100ms};
  policy.validate();
  EXPECT_EQ(policy.scale(100ms), 1.0);
  EXPECT_EQ(policy.scale(101ms), 0.0);
}

TEST(LateForcePolicy, RefusesDropTimeBelowHoldTime) {
  EXPECT_THROW((LateForcePolicy{.hold = 300ms, .drop = 200ms}.validate()), std::invalid_argument);
  EXPECT_THROW((LateForcePolicy{.hold = -1ms, .drop = 200ms}.validate()), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::client
