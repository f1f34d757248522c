#include "forcebound/client/rendering/foresight.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

/// Ticks of a millisecond; on each an answer tells of the force 50 ms before, which is zero.
struct Foretelling {
  void go_on(Nanoseconds duration, double modelled_N, double held_N) {
    const Nanoseconds end = now + duration;
    while (now < end) {
      say(modelled_N, held_N);
      foresight.compare(now - 50ms, Point::Zero());
    }
  }
  void say(double modelled_N, double held_N, bool modelled = true) {
    now += 1ms;
    foresight.remember({.time = now, .modelled = modelled, .modelled_N = {modelled_N, 0, 0}, .held_N = {0, held_N, 0}});
  }
  Foresight foresight;
  Nanoseconds now{1s};
};

TEST(Foresight, TrustsModelsBeforeAnythingWasCompared) {
  Foretelling one;
  EXPECT_EQ(one.foresight.trust(), 1);
  one.foresight.compare(one.now, {1, 0, 0});
  EXPECT_EQ(one.foresight.trust(), 1) << "nothing was said then";
  one.go_on(49ms, 5, 0);
  EXPECT_EQ(one.foresight.trust(), 1);
}

TEST(Foresight, TrustsModelsWhoseErrorIsAtMostHalfOfThatOfHolding) {
  Foretelling one;
  for (const double modelled_N : {0.0, 0.5, 0.99}) {
    one.go_on(500ms, modelled_N, 2);
    EXPECT_EQ(one.foresight.trust(), 1) << modelled_N;
  }
}

TEST(Foresight, GivesModelsUpWithin300MillisecondsWhereTheyAreWorseThanHolding) {
  Foretelling one;
  one.go_on(1s, 0.2, 1);
  EXPECT_EQ(one.foresight.trust(), 1);
  one.go_on(50ms + 300ms, 2, 1);
  EXPECT_EQ(one.foresight.trust(), 0);
  Foretelling from_the_beginning;
  from_the_beginning.go_on(60ms, 2, 1);
  EXPECT_EQ(from_the_beginning.foresight.trust(), 0);
}

TEST(Foresight, CountsModelsLessWhereTheyAreHardlyBetterThanHolding) {
  Foretelling one;
  one.go_on(5s, 3, 4);
  EXPECT_NEAR(one.foresight.trust(), 2 * (1 - 0.75), 1e-3);
}

TEST(Foresight, TrustsModelsAgainThatHaveBecomeRight) {
  Foretelling one;
  one.go_on(1s, 2, 1);
  EXPECT_EQ(one.foresight.trust(), 0);
  one.go_on(1s, 0, 1);
  EXPECT_EQ(one.foresight.trust(), 1);
}

TEST(Foresight, DoesNotMindSmallErrorsAtRest) {
  Foretelling one;
  one.go_on(2s, 0.49 * Foresight::kAgrees_N, 0);
  EXPECT_EQ(one.foresight.trust(), 1);
  one.go_on(5s, 0.75 * Foresight::kAgrees_N, 0);
  EXPECT_NEAR(one.foresight.trust(), 0.5, 1e-3);
  one.go_on(5s, 1.5 * Foresight::kAgrees_N, 0);
  EXPECT_EQ(one.foresight.trust(), 0);
}

TEST(Foresight, LearnsNothingFromAnswersOlderThanWhatItRemembers) {
  Foretelling one;
  for (int i = 0; i < 513; ++i) one.say(2, 0);
  one.foresight.compare(one.now - 512ms, Point::Zero());
  EXPECT_EQ(one.foresight.trust(), 1);
  one.foresight.compare(one.now - 511ms, Point::Zero());
  EXPECT_EQ(one.foresight.trust(), 0) << "the oldest of 512 ticks";
}

TEST(Foresight, LearnsNothingFromWhatIsNotFinite) {
  Foretelling one;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kMost = std::numeric_limits<double>::max();
  one.go_on(1s, 3, 4);
  const double before = one.foresight.trust();
  one.now += 1s;
  one.say(kNone, 0);
  one.foresight.compare(one.now, Point::Zero());
  one.say(0, kMost);
  one.foresight.compare(one.now, Point::Zero());
  one.say(9, 0);
  one.foresight.compare(one.now, {0, 0, kNone});
  EXPECT_EQ(one.foresight.trust(), before);
  one.go_on(2s, 0, 1);
  EXPECT_EQ(one.foresight.trust(), 1) << "it goes on";
}

TEST(Foresight, CountsNoTimeTwice) {
  Foretelling one;
  one.go_on(1s, 0, 1);
  one.go_on(170ms, 1.2, 1);
  const double before = one.foresight.trust();
  EXPECT_GT(before, 0.1);
  EXPECT_LT(before, 0.9);
  for (const Nanoseconds back : {50ms, 51ms, 90ms}) one.foresight.compare(one.now - back, Point::Zero());
  EXPECT_EQ(one.foresight.trust(), before) << "the same time again, and ones before it";
}

TEST(Foresight, LearnsNothingWhereNoModelHeld) {
  Foretelling one;
  for (int i = 0; i < 100; ++i) one.say(9, 0, false);
  one.foresight.compare(one.now, Point::Zero());
  EXPECT_EQ(one.foresight.trust(), 1);
  one.say(9, 0);
  one.foresight.compare(one.now, Point::Zero());
  EXPECT_EQ(one.foresight.trust(), 0);
}

TEST(Foresight, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Foretelling one;
  const test::AllocationGuard guard;
  one.go_on(1s, 1, 2);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::client
