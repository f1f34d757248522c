#include "forcebound/control/force_times.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace forcebound::control {
namespace {

/// In effect 1 to 1.5 ms after the command, held for 2 ms, stamps off by up to 0.1 ms.
DeviceFacts facts() {
  DeviceFacts facts;
  facts.damping = Matrix::Identity(1, 1);
  facts.hold_s_max = 2e-3;
  facts.latency_s = 1e-3;
  facts.uncertainty.latency_s = {0, 0.5e-3};
  facts.uncertainty.stamp_s = {-0.1e-3, 0.1e-3};
  return facts;
}

/// Of a force commanded 0.3 ms after its reading, read again after 10 ms.
Bracket effect_s(double reported_s) {
  Motion motion;
  motion.interval_s = 10e-3;
  motion.latency_s = 1.3e-3;
  motion.effect_s = reported_s;
  return ForceTimes(facts()).effect(motion);
}

void expect_near(const Bracket& a, const Bracket& b) {
  EXPECT_NEAR(a.least, b.least, 1e-12);
  EXPECT_NEAR(a.most, b.most, 1e-12);
}

constexpr Bracket kByFacts_s{1.3e-3, 1.8e-3};

TEST(ForceTimes, AreThoseOfTheFactsWithoutAReport) { expect_near(effect_s(std::nan("")), kByFacts_s); }

TEST(ForceTimes, AreThoseOfAReportThatTheFactsAllow) { expect_near(effect_s(1.4e-3), {1.3e-3, 1.5e-3}); }

TEST(ForceTimes, BelieveNoEffectBeforeItsCommand) { expect_near(effect_s(0.1e-3), kByFacts_s); }

TEST(ForceTimes, HoldTheReportAndTheFactsWhereTheyDisagree) {
  expect_near(effect_s(0.5e-3), {0.4e-3, 1.8e-3});
  expect_near(effect_s(3e-3), {1.3e-3, 3.1e-3});
}

TEST(ForceTimes, EndNotLaterThanTheReadingForAReportFromTheFuture) { expect_near(effect_s(1e9), {1.3e-3, 10.1e-3}); }

TEST(ForceTimes, HoldBothReleasesWhereReportAndFactsDisagree) {
  Motion motion;
  motion.interval_s = 10e-3;
  motion.latency_s = 1e-3;
  DeviceFacts exact = facts();
  exact.uncertainty = {};
  const ForceTimes times(exact);
  motion.held_s = 0.5e-3;
  expect_near(times.release(motion, times.effect(motion)).full_s, {0.5e-3, 2e-3});
  motion.held_s = 4e-3;
  expect_near(times.release(motion, times.effect(motion)).full_s, {2e-3, 4e-3});
  motion.held_s = 2e-3;
  expect_near(times.release(motion, times.effect(motion)).full_s, {2e-3, 2e-3});
}

}  // namespace
}  // namespace forcebound::control
