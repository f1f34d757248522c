// What surrounds a closed loop in simulation: environments, hands and clocks.

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/tools/sim/environment.hpp"
#include "tests/tools/sim/restless_hand.hpp"
#include "tests/tools/sim/skewed_clock.hpp"
#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

/// Pushes with half a newton along each axis.
class Scene final : public server::Environment {
 public:
  server::Answer respond(const server::Motion& motion) noexcept override {
    return {.force = Vector::Constant(motion.position.rows(), 0.5), .penetration_m = 1e-3};
  }
  server::EnvironmentFaults faults() const noexcept override { return {.old_normals = 3}; }
};

TEST(Environment, OfEachNameGivesTheSameForcesForTheSameSeed) {
  for (const auto& name : environment_names()) {
    SCOPED_TRACE(name);
    const EnvironmentSetting setting{.name = name, .seed = 4, .force_N_max = 5, .other_run = {Vector::Ones(2)}};
    Truth truth{.velocity = Vector::Constant(2, 1.0)};
    const auto one = make_environment(setting, std::make_unique<Scene>(), [&] { return truth; });
    const auto same = make_environment(setting, std::make_unique<Scene>(), [&] { return truth; });
    bool pushed = false;
    for (int i = 0; i < 200; ++i) {
      const Vector position = Vector::Constant(2, 1e-3 * i);
      truth.time = 1ms * i;
      truth.ledger_J = i < 100 ? 0.0 : 1.0;
      const server::Motion motion{.position = position};
      const Vector force = one->respond(motion).force;
      ASSERT_TRUE(force.allFinite());
      ASSERT_EQ(force, same->respond(motion).force);
      pushed = pushed || force.norm() > 0;
    }
    EXPECT_TRUE(pushed) << "it never pushed";
  }
}

TEST(Environment, ThatIsUnknownIsRefusedWithTheKnownOnes) {
  EXPECT_THROW((void)make_environment({.name = "angry"}, std::make_unique<Scene>(), {}), std::invalid_argument);
  EXPECT_THROW((void)taken_over({.name = "scene"}, {.name = "angry"}, {}), std::invalid_argument);
}

TEST(Environment, TakesOverTheForceAloneOfWhatTheSceneAnswers) {
  server::EnvironmentKind scene{.name = "scene", .make = [](const server::ClientFacts&) {
                                  return server::MadeEnvironment{std::make_unique<Scene>(), "half a newton", 77};
                                }};
  const Truth truth{.velocity = Vector::Constant(2, 1.0)};
  const auto made = taken_over(scene, {.name = "bang-bang", .force_N_max = 5}, [&] { return truth; }).make({});
  EXPECT_EQ(made.simulated, "half a newton");
  EXPECT_EQ(made.hash, 77U);
  const Vector at = Vector::Zero(2);
  const server::Answer answer = made.environment->respond({.position = at});
  EXPECT_NEAR(answer.force.norm(), 5, 1e-12);
  EXPECT_EQ(answer.penetration_m, 1e-3);
  EXPECT_EQ(made.environment->faults().old_normals, 3U);
}

TEST(Environment, TurnsATipThatTurnsByAForceAtTheLever) {
  const auto environment_at = [](double lever_m) {
    Truth truth{.velocity = Vector::Zero(3)};
    truth.turning = 2 * Vector::Unit(3, 1);
    return make_environment({.name = "bang-bang", .force_N_max = 5, .lever_m = lever_m}, std::make_unique<Scene>(),
                            [truth] { return truth; });
  };
  const Vector at = Vector::Zero(3);
  const server::Motion motion{.position = at, .handle = {.orientation = control::Handle::Orientation{1, 0, 0, 0}}};
  const server::Answer answer = environment_at(0.5)->respond(motion);
  EXPECT_EQ(answer.force, at) << "the tip rests";
  EXPECT_EQ(answer.torque_N_m, Vector(2.5 * Vector::Unit(3, 1)));
  EXPECT_EQ(environment_at(0)->respond(motion).torque_N_m.rows(), 0) << "as without a lever";
}

TEST(GreedyEnvironment, PushesAlongTheMotionOnceTheLedgerIsFull) {
  Truth truth{.velocity = Vector::Constant(1, -0.3)};
  const auto greedy = make_environment({.name = "greedy", .seed = 1, .force_N_max = 7}, std::make_unique<Scene>(),
                                       [&] { return truth; });
  const Vector at = Vector::Zero(1);
  const auto force_N = [&](Nanoseconds time, double ledger_J) {
    truth.time = time;
    truth.ledger_J = ledger_J;
    return greedy->respond({.position = at}).force[0];
  };
  EXPECT_LT(std::abs(force_N(0ms, 0.0)), 1) << "it waits while the ledger fills";
  EXPECT_DOUBLE_EQ(force_N(1ms, 1.0), -7) << "and spends it";
  EXPECT_LT(std::abs(force_N(2ms, 0.0)), 1) << "until nothing is left";
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

TEST(RestlessHand, TurnsATipAboutItsMiddleOnlyIfAskedTo) {
  const Vector middle_m = Vector::Unit(3, 2);
  const RestlessHand::Settings straight{.seed = 5, .degrees_of_freedom = 3, .reach_m = 0, .duration_s = 5};
  RestlessHand::Settings turning = straight;
  turning.turn_rad = 0.3;
  turning.middle_m = middle_m;
  double most_rad = 0;
  const RestlessHand still(straight);
  const RestlessHand hand(turning);
  for (int ms = 0; ms < 5000; ++ms) {
    ASSERT_TRUE(still.turn(1e-3 * ms).isZero(0));
    ASSERT_LT((hand.target(1e-3 * ms).position - middle_m).norm(), 0.02);
    most_rad = std::max(most_rad, hand.turn(1e-3 * ms).norm());
  }
  EXPECT_GT(most_rad, 0.1);
  EXPECT_LT(most_rad, 0.3 * 2);
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
  EXPECT_LT(jumps, 5) << "except between two phases";
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
