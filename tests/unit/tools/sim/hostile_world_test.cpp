// The worlds that closed loops are played in: environments, hands and clocks.

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/tools/sim/environment.hpp"
#include "tests/tools/sim/restless_hand.hpp"
#include "tests/tools/sim/skewed_clock.hpp"
#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

TEST(Environment, OfEachNameGivesTheSameForcesForTheSameSeed) {
  for (const auto& name : environment_names()) {
    SCOPED_TRACE(name);
    const EnvironmentSetting setting{.name = name, .seed = 4, .force_N_max = 5, .other_run = {Vector::Ones(2)}};
    const auto one = make_environment(setting);
    const auto same = make_environment(setting);
    bool pushed = false;
    for (int i = 0; i < 200; ++i) {
      const Vector position = Vector::Constant(2, 1e-3 * i);
      const Vector velocity = Vector::Constant(2, 1.0);
      const Vector own = Vector::Constant(2, 0.5);
      const EnvironmentView view{1ms * i, position, velocity, position, own, i < 100 ? 0.0 : 1.0};
      const Vector force = one->force(view);
      ASSERT_TRUE(force.allFinite());
      ASSERT_EQ(force, same->force(view));
      pushed = pushed || force.norm() > 0;
    }
    EXPECT_TRUE(pushed) << "it never did anything";
  }
}

TEST(Environment, ThatIsUnknownIsRefusedWithTheKnownOnes) {
  EXPECT_THROW((void)make_environment({.name = "angry"}), std::invalid_argument);
}

TEST(GreedyEnvironment, PushesAlongTheMotionOnceTheLedgerIsFull) {
  const auto greedy = make_environment({.name = "greedy", .seed = 1, .force_N_max = 7});
  const Vector at = Vector::Zero(1);
  const Vector back = Vector::Constant(1, -0.3);
  EXPECT_LT(std::abs(greedy->force({0ms, at, back, at, at, 0.0})[0]), 1) << "it waits";
  EXPECT_DOUBLE_EQ(greedy->force({1ms, at, back, at, at, 1.0})[0], -7) << "and raids";
  EXPECT_LT(std::abs(greedy->force({2ms, at, back, at, at, 0.0})[0]), 1) << "until nothing is left";
}

TEST(RestlessHand, PullsHoldsShakesAndLetsGoWithoutAJump) {
  const RestlessHand hand({.seed = 2, .degrees_of_freedom = 3, .reach_m = 0.02, .duration_s = 20});
  bool let_go = false;
  bool pulled = false;
  auto before = hand.target(0);
  for (int i = 1; i < 25'000; ++i) {
    const auto target = hand.target(1e-3 * i);
    ASSERT_LE((target.position - before.position).norm(), 5e-3);
    ASSERT_LE(target.position.lpNorm<Eigen::Infinity>(), 0.03);
    let_go = let_go || target.grip == 0;
    pulled = pulled || target.velocity.norm() > 0.01;
    before = target;
  }
  EXPECT_TRUE(let_go);
  EXPECT_TRUE(pulled);
  EXPECT_EQ(before.velocity.norm(), 0) << "it holds in the end";
}

TEST(RestlessHand, MovesAsItsVelocitySays) {
  const RestlessHand hand({.seed = 5, .degrees_of_freedom = 1, .duration_s = 5});
  constexpr double kStep_s = 1e-6;
  int jumps = 0;
  for (int i = 1; i < 5000; ++i) {
    const double t = 1e-3 * i;
    const double slope = (hand.target(t + kStep_s).position - hand.target(t - kStep_s).position)[0] / (2 * kStep_s);
    jumps += std::abs(slope - hand.target(t).velocity[0]) > 1e-3;
  }
  EXPECT_LT(jumps, 5) << "other than where one act ends and another begins";
}

TEST(SkewedClock, RunsAndJumpsByItself) {
  VirtualClock truth;
  const SkewedClock clock(truth, {.offset = 1h, .rate_error = 1e-4, .jumps = {{10s, -3s}}});
  EXPECT_EQ(clock.now(), 1h);
  truth.set(5s);
  EXPECT_EQ(clock.now(), 1h + 5s + 500us);
  EXPECT_EQ(clock.shown_at(10s), 1h + 7s + 1ms);
}

TEST(TickClock, ShowsTheTimeOfTheChoiceAndThenOfTheCommand) {
  VirtualClock truth(1s);
  TickClock clock(truth);
  clock.begin_tick(5us, 9us);
  EXPECT_EQ(clock.now(), 1s + 5us);
  EXPECT_EQ(clock.now(), 1s + 9us);
  EXPECT_EQ(clock.now(), 1s + 9us);
}

}  // namespace
}  // namespace forcebound::sim
