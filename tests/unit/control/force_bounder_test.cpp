#include "forcebound/control/force_bounder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/support/ideal_device.hpp"
#include "tests/support/published_law_checks.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kB_N_per_m;
using test::kDamping_N_s_per_m;
using test::kNaN;
using test::LawLoop;
using test::to_matrix;
using test::to_vector;

DeviceFacts three_axes() {
  DeviceFacts facts;
  facts.name = "three axes";
  facts.damping = Matrix::Identity(3, 3);
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(3);
  facts.force_N_max = 10;
  return facts;
}

std::string refusal_of_device(const DeviceFacts& facts) {
  try {
    const ForceBounder bounder(facts, published_laws().make("none", facts));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ForceBounder, TakesForcesOfTheTipFromAnArmWithMoreJoints) {
  DeviceFacts facts = three_axes();
  facts.cartesian = false;
  facts.tip_axes = 2;
  EXPECT_EQ(refusal_of_device(facts), "accepted");
  ForceBounder bounder(facts, std::make_unique<ExactLaw>(facts, EnergyMemory::full));
  const Damping damping = Damping::from_joints(to_matrix({{1, 0, 0.5}, {0, 1, 0.2}}), facts.damping);
  Motion motion{.position = to_vector({0, 0}),
                .joint = to_vector({0, 0, 0}),
                .jacobian = to_matrix({{1, 0, 0.5}, {0, 1, 0.2}}),
                .damping = &damping};
  EXPECT_EQ(bounder.tick(motion, to_vector({1, 1})), to_vector({0, 0})) << "nothing to spend yet";
  motion.interval_s = 1e-3;
  motion.joint = to_vector({0.01, 0, 0.02});
  EXPECT_EQ(bounder.tick(motion, to_vector({1e-3, 1e-3})), to_vector({1e-3, 1e-3}));
  EXPECT_EQ(bounder.tick(motion, to_vector({1, 1, 1})), to_vector({0, 0}));
  EXPECT_EQ(bounder.counts().requests_not_finite, 1U);
}

TEST(ForceBounder, RefusesActuatorStepsWhereJointsOutnumberAxes) {
  DeviceFacts facts = three_axes();
  facts.cartesian = false;
  facts.tip_axes = 2;
  facts.actuator_step = Vector::Constant(3, 1e-3);
  EXPECT_THAT(refusal_of_device(facts), testing::HasSubstr("actuator step must be 0 for 3 joints and a tip of 2"));
}

TEST(ForceBounder, SaturatesAlongTheRequest) {
  LawLoop loop("none", Matrix::Identity(3, 3), {.force_N_max = 10});
  EXPECT_TRUE(loop.tick(to_vector({0, 0, 0}), to_vector({30, 0, -40})).isApprox(to_vector({6, 0, -8}), 1e-15));
  EXPECT_EQ(loop.counts().saturated, 1U);
  EXPECT_EQ(loop.tick(to_vector({0, 0, 0}), to_vector({6, 0, -7})), to_vector({6, 0, -7}));
  EXPECT_EQ(loop.counts().saturated, 1U);
}

TEST(ForceBounder, WithdrawsAForceCommandedBeforeItsReading) {
  DeviceFacts facts = three_axes();
  facts.latency_s = 1e-3;
  ForceBounder bounder(facts, published_laws().make("none", facts));
  const Vector force_N = to_vector({1, 2, 3});
  EXPECT_EQ(bounder.confirmed(force_N, 1e-3), force_N);
  for (const double latency_s : {0.5e-3, -1e-3, kNaN}) {
    EXPECT_EQ(bounder.confirmed(force_N, latency_s), Vector::Zero(3)) << latency_s;
  }
  EXPECT_EQ(bounder.counts().withdrawn, 3U);
}

/// Gives whatever it was made with.
class FaultyLaw final : public PassivityLaw {
 public:
  explicit FaultyLaw(Vector force_N) : force_N_(std::move(force_N)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "faulty"; }
  void credit(const Motion&) noexcept override {}
  void lose(const Motion&) noexcept override {}
  [[nodiscard]] Vector bound(const Vector&) noexcept override { return force_N_; }
  void commit(const Vector&) noexcept override {}
  [[nodiscard]] double energy_J() const noexcept override { return 0; }

 private:
  Vector force_N_;
};

Vector force_of_faulty_law(const Vector& force_N, bool released = false) {
  const DeviceFacts facts = three_axes();
  const Damping damping = Damping::from_matrix(facts.damping);
  ForceBounder bounder(facts, std::make_unique<FaultyLaw>(force_N));
  Motion motion;
  motion.position = motion.joint = Vector::Zero(3);
  motion.jacobian = Matrix::Identity(3, 3);
  motion.damping = &damping;
  return released ? bounder.release(motion) : bounder.tick(motion, Vector::Zero(3));
}

TEST(ForceBounder, GivesNoForceThatIsNotFiniteOrBeyondTheDeviceWhateverTheLawSays) {
  EXPECT_EQ(force_of_faulty_law(to_vector({kNaN, 0, 0})), to_vector({0, 0, 0}));
  EXPECT_EQ(force_of_faulty_law(to_vector({1, 2})), to_vector({0, 0, 0}));
  EXPECT_TRUE(force_of_faulty_law(to_vector({0, 3e6, 4e6})).isApprox(to_vector({0, 6, 8}), 1e-15));
}

TEST(ForceBounder, ReleasesTheDeviceWhateverTheLawWouldGoOnWith) {
  EXPECT_EQ(force_of_faulty_law(to_vector({1, 2, 3}), true), to_vector({0, 0, 0}));
}

TEST(ForceBounder, SaturatesTheLargestNumbersThereAre) {
  const double most = std::numeric_limits<double>::max();
  LawLoop loop("none", Matrix::Identity(3, 3), {.force_N_max = 3});
  EXPECT_TRUE(loop.tick(to_vector({0, 0, 0}), to_vector({most, -most, most}))
                  .isApprox(std::sqrt(3.0) * to_vector({1, -1, 1}), 1e-15));
}

TEST(ForceBounder, TakesARequestThatIsNotFiniteForNoForce) {
  LawLoop loop("none", Matrix::Identity(3, 3));
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(loop.tick(to_vector({0, 0, 0}), to_vector({1, bad, 1})), to_vector({0, 0, 0}));
  }
  EXPECT_EQ(loop.tick(to_vector({0, 0, 0}), to_vector({1, 1})), to_vector({0, 0, 0})) << "too few components";
  EXPECT_EQ(loop.counts().requests_not_finite, 4U);
  EXPECT_EQ(loop.tick(to_vector({0, 0, 0}), to_vector({1, 2, 3})), to_vector({1, 2, 3}));
}

TEST(ForceBounder, ChargesALostReadingItsWorstCaseAndRecovers) {
  LawLoop loop("fba-less", Matrix::Constant(1, 1, kDamping_N_s_per_m));
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, 20.0), 20.0);
  const double saved_J = kB_N_per_m * 1e-6;
  EXPECT_EQ(loop.tick(kNaN, 20.0), 0.0);
  const double left_J = saved_J - 400 / (4 * kB_N_per_m);
  EXPECT_NEAR(loop.energy_J(), left_J, 1e-15);
  EXPECT_EQ(loop.tick(kNaN, 20.0), 0.0);
  EXPECT_EQ(loop.counts().readings_not_finite, 2U);
  EXPECT_EQ(loop.tick(5.0, 20.0), 20.0) << "did not recover";
  EXPECT_NEAR(loop.energy_J(), left_J, 1e-15) << "credited a motion nobody saw";
  loop.tick(5.0, 20.0);
  EXPECT_NEAR(loop.energy_J(), left_J, 1e-15);
}

TEST(ForceBounder, ForgetsUnderTheMoreConservativeLawAtALostReadingAndRecovers) {
  LawLoop loop("fba-more", Matrix::Constant(1, 1, kDamping_N_s_per_m));
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, 20.0), 20.0);
  EXPECT_EQ(loop.tick(kNaN, 20.0), 0.0);
  EXPECT_EQ(loop.energy_J(), 0.0);
  EXPECT_EQ(loop.tick(5.0, 20.0), 0.0);
  EXPECT_EQ(loop.tick(5.001, 20.0), 20.0) << "did not recover";
}

TEST(ForceBounder, StaysPassiveThroughLostReadings) {
  for (const char* law : {"fba-less", "fba-more"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      LawLoop loop(law, test::full_damping(3, seed));
      int tick = 0;
      const test::Extraction result =
          test::play({.seed = seed,
                      .degrees_of_freedom = 3,
                      .dampings = [&](int) { return test::full_damping(3, seed); },
                      .law =
                          [&](const Vector& position, const Vector& request, const Matrix&) {
                            const bool lost = ++tick % 7 == 0 || tick % 50 < 3;
                            return loop.tick(lost ? Vector(Vector::Constant(3, kNaN)) : position, request);
                          }});
      EXPECT_GE(result.least_J, -1e-13L * result.turnover_J) << law << ", seed " << seed;
    }
  }
}

TEST(ForceBounder, LeavesAWholeNumberOfActuatorStepsAsItIs) {
  LawLoop loop("none", Matrix::Identity(1, 1), {.actuator_step_N = 0.1});
  for (int count = -2000; count <= 2000; ++count) {
    const double command_N = count * 0.1;
    ASSERT_EQ(loop.tick(0.0, command_N), command_N) << count;
  }
}

TEST(ForceBounder, RoundsTowardNoForce) {
  LawLoop loop("none", Matrix::Identity(2, 2), {.actuator_step_N = 0.25});
  EXPECT_EQ(loop.tick(to_vector({0, 0}), to_vector({0.99, -0.99})), to_vector({0.75, -0.75}));
  EXPECT_EQ(loop.tick(to_vector({0, 0}), to_vector({0.24, 1.0})), to_vector({0, 1}));
}

TEST(ForceBounder, StaysPassiveAnd12BitsSeenByTheLedger) {
  // A ledger that saw the unrounded force would drift away from the balance of what was applied.
  const test::LawLoopSetting setting{.force_N_max = 20, .actuator_step_N = 40.0 / 4096};
  for (const int degrees_of_freedom : {1, 3, 6}) {
    const Matrix damping = test::full_damping(degrees_of_freedom, 9);
    LawLoop loop("fba-less", damping, setting);
    Vector last;
    const test::Extraction result =
        test::play({.seed = 9,
                    .degrees_of_freedom = degrees_of_freedom,
                    .dampings = [&](int) { return damping; },
                    .law =
                        [&](const Vector& position, const Vector& request, const Matrix&) {
                          last = position;
                          const Vector force = loop.tick(position, request);
                          EXPECT_EQ(force, Vector((force / setting.actuator_step_N).array().round().matrix() *
                                                  setting.actuator_step_N));
                          return force;
                        }});
    EXPECT_GE(result.least_J, -1e-13L * result.turnover_J);
    EXPECT_GT(result.turnover_J, 1e-6L) << "nothing happened";
  }
  test::expect_passive_against_any_adversary("fba-less", setting);
  test::expect_passive_against_any_adversary("fba-more", setting);
}

TEST(ForceBounder, ChargesTheRoundedForce) {
  LawLoop loop("fba-less", Matrix::Constant(1, 1, kDamping_N_s_per_m), {.actuator_step_N = 0.25});
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, 0.99), 0.75);
  loop.tick(2e-3, 0.0);
  EXPECT_NEAR(loop.energy_J(), 2 * kB_N_per_m * 1e-6 - 0.75e-3, 1e-15);
}

TEST(ForceBounder, GivesNoForceWhereRoundingNeedsMoreEnergyThanThereIs) {
  // Damping that couples the axes: (1.02, 0.99) N needs 0.25 mJ, its rounding (1, 0) N a hundred times as much.
  const Matrix damping = to_matrix({{1, 0.999}, {0.999, 1}});
  const Vector motion = to_vector({0.6e-3, 0.6e-3});
  LawLoop exact("fba-less", damping);
  LawLoop coarse("fba-less", damping, {.actuator_step_N = 1});
  for (LawLoop* loop : {&exact, &coarse}) loop->tick(to_vector({0, 0}), to_vector({0, 0}));
  const Vector request = to_vector({1.02, 0.99});
  EXPECT_EQ(exact.tick(motion, request), request);
  EXPECT_EQ(coarse.tick(motion, request), to_vector({0, 0}));
  EXPECT_NEAR(coarse.energy_J(), exact.energy_J(), 1e-18);
}

TEST(ForceBounder, TakesLessThanTheSquareOfAnyNumberForNothing) {
  for (const char* law : {"none", "fba-less", "fba-more", "fba-exact"}) {
    test::LawLoop loop(law, 30 * Matrix::Identity(1, 1));
    (void)loop.tick(0.0, 0.0);
    for (const double request_N : {4.9e-324, 1e-310, 1e-200, 9.9e-151}) EXPECT_EQ(loop.tick(1e-4, request_N), 0) << law;
    EXPECT_EQ(loop.tick(2e-4, 1.01e-150), 1.01e-150) << law;
  }
}

/// An arm of three joints whose motors turn in counts.
class ArmTest : public testing::TestWithParam<const char*> {
 protected:
  static constexpr double kStep_Nm = 2e-3;

  ArmTest() : bounder_(make_bounder()) {}

  static DeviceFacts facts() {
    DeviceFacts facts = three_axes();
    facts.cartesian = false;
    facts.damping = to_matrix({{1e-2, 0, 0}, {0, 2e-2, 0}, {0, 0, 5e-3}});
    facts.actuator_step = Vector::Constant(3, kStep_Nm);
    return facts;
  }

  static ForceBounder make_bounder() { return {facts(), published_laws().make(GetParam(), facts())}; }

  Vector tick(const Vector& position, const Vector& request, const Matrix& jacobian) {
    damping_ = Damping::from_joints(jacobian, facts().damping);
    Motion motion;
    motion.interval_s = 1e-3;
    motion.position = motion.joint = position;
    motion.jacobian = jacobian;
    motion.damping = &damping_;
    return bounder_.tick(motion, request);
  }

  static Matrix jacobian_at(int tick) {
    const double turn = 0.3 * std::sin(tick * 0.05);
    return to_matrix({{0.13 * std::cos(turn), 0.05, 0}, {-0.02, 0.13, 0.13 * std::sin(turn)}, {0.01, 0.04, 0.1}});
  }

  Damping damping_ = Damping::from_matrix(Matrix::Identity(3, 3));
  ForceBounder bounder_;
};

TEST_P(ArmTest, RoundsInTheJointsTowardNoTorque) {
  int told = 0;
  for (int i = 0; i < 500; ++i) {
    const Matrix jacobian = jacobian_at(i);
    const Vector request = to_vector({std::sin(i * 0.1), std::cos(i * 0.17), 0.5});
    const Vector force = tick(Vector::Constant(3, i * 1e-3), request, jacobian);
    const Vector counts = jacobian.transpose() * force / kStep_Nm;
    const Vector most = jacobian.transpose() * request / kStep_Nm;
    for (Eigen::Index joint = 0; joint < 3; ++joint) {
      ASSERT_NEAR(counts[joint], std::round(counts[joint]), 1e-9);
      ASSERT_LE(std::abs(counts[joint]), std::abs(most[joint]) + 1e-9);
    }
    told += force.isZero(0) ? 0 : 1;
  }
  EXPECT_GT(told, 400);
}

TEST_P(ArmTest, IsPassiveHoweverTheArmTurnsUnlessThereIsNoLaw) {
  int tick_number = 0;
  const test::Extraction result = test::play(
      {.seed = 4,
       .degrees_of_freedom = 3,
       .dampings = [&](int i) { return Damping::from_joints(jacobian_at(i), facts().damping).matrix(); },
       .law = [&](const Vector& x, const Vector& f, const Matrix&) { return tick(x, f, jacobian_at(tick_number++)); }});
  EXPECT_GT(result.turnover_J, 1e-6L);
  if (std::string(GetParam()) == "none") {
    EXPECT_LT(result.least_J, -0.1L * result.turnover_J) << "this adversary proves nothing";
  } else {
    EXPECT_GE(result.least_J, -1e-12L * result.turnover_J);
  }
}

TEST_P(ArmTest, GivesAFiniteForceInAndNearSingularConfigurations) {
  for (int i = 0; i < 200; ++i) {
    const double distance = i % 3 == 0 ? 0.0 : std::pow(10.0, -(i % 20));
    const Matrix jacobian = to_matrix({{0.1, 0.1, 0}, {0.1, 0.1 + distance, 0}, {0, 0, 0.1}});
    const Vector force = tick(Vector::Constant(3, i * 1e-3), to_vector({1, 1, -1}), jacobian);
    ASSERT_TRUE(force.allFinite()) << "distance " << distance;
    ASSERT_TRUE(std::isfinite(bounder_.law().energy_J()));
  }
}

TEST_P(ArmTest, TakesAJacobianThatIsNotFiniteForALostReading) {
  Matrix jacobian = jacobian_at(0);
  jacobian(1, 2) = kNaN;
  EXPECT_EQ(tick(Vector::Zero(3), to_vector({1, 1, 1}), jacobian), to_vector({0, 0, 0}));
  EXPECT_EQ(bounder_.counts().readings_not_finite, 1U);
}

TEST_P(ArmTest, TakesAJointThatIsNotFiniteForALostReading) {
  Motion motion;
  motion.interval_s = 1e-3;
  motion.position = Vector::Zero(3);
  motion.joint = to_vector({0, kNaN, 0});
  motion.jacobian = jacobian_at(0);
  motion.damping = &damping_;
  EXPECT_EQ(bounder_.tick(motion, to_vector({1, 1, 1})), to_vector({0, 0, 0}));
  EXPECT_EQ(bounder_.counts().readings_not_finite, 1U);
}

INSTANTIATE_TEST_SUITE_P(Laws, ArmTest, testing::Values("none", "fba-less", "fba-more"), [](const auto& law) {
  const std::string name = law.param;
  return name == "none" ? "None" : name == "fba-less" ? "LessConservative" : "MoreConservative";
});

TEST(ForceBounder, TakesAReadingFurtherThanTheDeviceCanBeForALostOne) {
  DeviceFacts facts = three_axes();
  facts.speed_max = Vector::Constant(3, 1);
  ForceBounder bounder(facts, published_laws().make("none", facts));
  const Damping damping = Damping::from_matrix(facts.damping);
  Motion motion;
  motion.jacobian = Matrix::Identity(3, 3);
  motion.damping = &damping;
  const auto tick = [&](double at_m) {
    motion.position = motion.joint = Vector::Constant(3, at_m);
    const Vector force = bounder.tick(motion, to_vector({1, 1, 1}));
    motion.interval_s = 1e-3;
    return force[0];
  };
  EXPECT_EQ(tick(0), 1);
  EXPECT_EQ(tick(0.9e-3), 1);
  EXPECT_EQ(tick(0.5), 0) << "a glitch";
  EXPECT_EQ(tick(2.5e-3), 1) << "two ticks away from the last good one";
  EXPECT_EQ(bounder.counts().readings_too_far, 1U);
}

/// Of fba-exact on a device of at most 1 m/s.
class FirstReading : public testing::Test {
 protected:
  void tick(double at_m, double interval_s = 1e-3) {
    motion_.jacobian = Matrix::Identity(3, 3);
    motion_.damping = &damping_;
    motion_.position = motion_.joint = Vector::Constant(3, at_m);
    motion_.interval_s = begun_ ? interval_s : 0;
    begun_ = true;
    (void)bounder_.tick(motion_, to_vector({1, 1, 1}));
    most_J_ = std::max(most_J_, bounder_.law().energy_J());
  }

  static DeviceFacts slow_device() {
    DeviceFacts facts = three_axes();
    facts.friction = facts.encoder_step = Vector::Zero(3);
    facts.speed_max = Vector::Constant(3, 1);
    return facts;
  }

  DeviceFacts facts_ = slow_device();
  Damping damping_ = Damping::from_matrix(facts_.damping);
  ForceBounder bounder_{facts_, std::make_unique<ExactLaw>(facts_, EnergyMemory::full)};
  Motion motion_;
  bool begun_ = false;
  double most_J_ = 0;
};

TEST_F(FirstReading, CreditsNoMotionFromWhereTheDeviceNeverWas) {
  tick(0.5);
  for (int i = 0; i < 600; ++i) tick(0);
  EXPECT_EQ(most_J_, 0);
  EXPECT_EQ(bounder_.counts().readings_too_far, 1U);
}

TEST_F(FirstReading, CreditsNoMotionFromWhereTheDeviceNeverWasAfterAnImpossibleInterval) {
  tick(0);
  tick(kNaN, 0);
  for (int i = 0; i < 20; ++i) tick(kNaN);
  tick(0.5);
  for (int i = 0; i < 600; ++i) tick(0);
  EXPECT_EQ(most_J_, 0);
  EXPECT_EQ(bounder_.counts().readings_too_far, 1U);
}

TEST_F(FirstReading, IsUsedAgainSoonAfterAWrongOneWhoseClockFailed) {
  tick(0);
  tick(0.5, 0);
  for (int i = 0; i < 20; ++i) tick(0);
  EXPECT_LE(bounder_.counts().readings_too_far, 2U);
  tick(0.5e-3);
  EXPECT_GT(bounder_.law().energy_J(), 0);
}

TEST(ForceBounder, CountsTimesOfADeviceThatItsFactsDoNotAllow) {
  DeviceFacts facts = three_axes();
  facts.latency_s = 1e-3;
  facts.uncertainty.latency_s = {-0.2e-3, 0.5e-3};
  facts.uncertainty.hold_s = {-0.1e-3, 0.1e-3};
  ForceBounder bounder(facts, published_laws().make("none", facts));
  const Damping damping = Damping::from_matrix(facts.damping);
  Motion motion;
  motion.position = motion.joint = Vector::Zero(3);
  motion.jacobian = Matrix::Identity(3, 3);
  motion.damping = &damping;
  motion.interval_s = 5e-3;
  motion.latency_s = 1.3e-3;  // commanded at 0.3 ms
  std::uint64_t counted = 0;
  for (const auto& [effect_s, outside] :
       {std::pair{kNaN, false}, {0.2e-3, true}, {1.0e-3, true}, {1.1e-3, false}, {1.8e-3, false}, {1.9e-3, true}}) {
    motion.effect_s = effect_s;
    (void)bounder.tick(motion, to_vector({1, 1, 1}));
    counted += outside;
    EXPECT_EQ(bounder.counts().effects_outside_facts, counted) << effect_s;
  }
  motion.effect_s = kNaN;
  counted = 0;
  for (const auto& [held_s, outside] : {std::pair{facts.hold_s_max, false},
                                        {facts.hold_s_max - 0.5e-3, true},
                                        {facts.hold_s_max + 0.5e-3, false},
                                        {facts.hold_s_max + 0.7e-3, true}}) {
    motion.held_s = held_s;
    (void)bounder.tick(motion, to_vector({1, 1, 1}));
    counted += outside;
    EXPECT_EQ(bounder.counts().releases_outside_facts, counted) << held_s;
  }
}

TEST(ForceBounder, RefusesToWorkWithoutALaw) {
  EXPECT_THROW(ForceBounder(three_axes(), nullptr), std::invalid_argument);
}

TEST(ForceBounder, RefusesFactsThatMakeNoSense) {
  DeviceFacts facts = three_axes();
  facts.actuator_step = Vector::Zero(2);
  EXPECT_EQ(refusal_of_device(facts), "device 'three axes': actuator step must have 3 rows, got 2");
  facts = three_axes();
  facts.actuator_step[1] = -0.5;
  EXPECT_THAT(refusal_of_device(facts), testing::HasSubstr("actuator step must be >= 0, got"));
  for (const double force_N_max : {-1.0, kNaN}) {
    facts = three_axes();
    facts.force_N_max = force_N_max;
    EXPECT_THAT(refusal_of_device(facts), testing::HasSubstr("largest force must be >= 0 N, got"));
  }
}

}  // namespace
}  // namespace forcebound::control
