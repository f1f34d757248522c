#include "forcebound/control/force_bounded_leader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/control/exact_law.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kNaN;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;

LeaderJoint servo(const std::string& name = "elbow") {
  return {.name = name,
          .damping_N_m_s_per_rad = 0.15,
          .friction_N_m = 0.03,
          .encoder_step_rad = 0.0015339807878856,
          .torque_N_m_max = 1,
          .speed_rad_per_s_max = 30};
}

LeaderFacts arm(std::size_t joints, double rate_Hz = 200) {
  return {.joints = std::vector<LeaderJoint>(joints, servo()),
          .period_s = 1 / rate_Hz,
          .latency_s_max = 0.2 / rate_Hz,
          .read_s_max = 0.1 / rate_Hz};
}

std::string refusal_of(const LeaderFacts& facts) {
  try {
    const ForceBoundedLeader leader(facts);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

/// A loop in which all joints move alike, and are asked for the same torque.
class Loop {
 public:
  explicit Loop(const LeaderFacts& facts) : leader(facts), torque_N_m(facts.joints.size()) {}

  const std::vector<double>& step(double position_rad, double feedback_N_m, double interval_s) {
    const std::vector<double> positions(torque_N_m.size(), position_rad);
    const std::vector<double> feedback(torque_N_m.size(), feedback_N_m);
    leader.step(positions, feedback, interval_s, torque_N_m);
    return torque_N_m;
  }

  /// Moves on at 1 rad/s against what is asked for, until it is given.
  Loop& warmed_up() {
    for (int n = 0; n < 100; ++n) step(at_rad += leader.facts().period_s, -1, leader.facts().period_s);
    EXPECT_THAT(torque_N_m, Each(-1));
    return *this;
  }

  ForceBoundedLeader leader;
  std::vector<double> torque_N_m;
  double at_rad = 0;
};

TEST(ForceBoundedLeader, GivesEachJointTheTorqueOfALawOfItsOwn) {
  const LeaderFacts facts = arm(8);
  ForceBoundedLeader leader(facts);
  DeviceFacts one;
  one.name = "elbow";
  one.period_s = 1.0 / 200;
  one.damping = Matrix::Constant(1, 1, 0.15);
  one.friction = Vector::Constant(1, 0.03);
  one.encoder_step = Vector::Constant(1, 0.0015339807878856);
  one.actuator_step = Vector::Zero(1);
  one.speed_max = Vector::Constant(1, 30);
  one.force_N_max = 1;
  one.releases = false;
  one.hold_s_max = leader.facts().hold_s_max;
  one.uncertainty = {.stamp_s = {0, 0.1 / 200}, .latency_s = {0, 0.2 / 200}, .clock_share = 1e-4};
  std::vector<ForceBounder> alone;
  alone.reserve(8);
  for (int i = 0; i < 8; ++i) {
    alone.emplace_back(one, std::make_unique<ExactLaw>(one, EnergyMemory::capped,
                                                       Spending{.memory_reserves = 1e9, .memory_J_max = 0.1}));
  }
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp,cert-msc32-c)
  std::normal_distribution<double> drawn;
  std::vector<double> position(8), feedback(8), torque(8);
  int felt = 0;
  for (int n = 0; n < 500; ++n) {
    Motion motion;
    motion.interval_s = n == 0 ? 0 : 0.005;
    motion.jacobian = Matrix::Identity(1, 1);
    for (std::size_t i = 0; i < 8; ++i) {
      position[i] += 3e-3 * drawn(random);
      feedback[i] = -2 * position[i] + 0.2 * drawn(random);
    }
    leader.step(position, feedback, 0.005, torque);
    for (std::size_t i = 0; i < 8; ++i) {
      motion.position = motion.joint = Vector::Constant(1, position[i]);
      ASSERT_EQ(torque[i], alone[i].tick(motion, Vector::Constant(1, feedback[i]))[0]);
      ASSERT_EQ(leader.energy_J(i), alone[i].law().energy_J());
      felt += torque[i] != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(felt, 1000);
}

TEST(ForceBoundedLeader, RefusesFactsThatCannotBeWithTheJointsName) {
  EXPECT_EQ(refusal_of(arm(6)), "accepted");
  EXPECT_THAT(refusal_of({}), HasSubstr("there must be a joint or more"));
  const std::vector<std::pair<std::function<void(LeaderJoint&)>, std::string>> joints{
      {[](auto& j) { j.torque_N_m_max = 0; }, "leader: joint 'elbow': torque_N_m_max must be > 0, got 0"},
      {[](auto& j) { j.torque_N_m_max = kInfinity; }, "torque_N_m_max must be > 0, got inf"},
      {[](auto& j) { j.damping_N_m_s_per_rad = 0; }, "damping_N_m_s_per_rad must be > 0, got 0"},
      {[](auto& j) { j.friction_N_m = -1; }, "friction_N_m must be >= 0, got -1"},
      {[](auto& j) { j.encoder_step_rad = kNaN; }, "encoder_step_rad must be > 0, got nan"},
      {[](auto& j) { j.backlash_rad = -1; }, "backlash_rad must be >= 0"},
      {[](auto& j) { j.torque_step_N_m = -1; }, "torque_step_N_m must be >= 0"},
      {[](auto& j) { j.torque_gain_share = 1; }, "torque_gain_share must be >= 0 and < 1, got 1"},
      {[](auto& j) { j.torque_ripple_share = 1; }, "torque_ripple_share must be >= 0 and < 1, got 1"},
      {[](auto& j) { j.speed_rad_per_s_max = -1; }, "speed_rad_per_s_max must be >= 0"},
      {[](auto& j) { j.goal_stiffness_N_m_per_rad = -1; }, "goal_stiffness_N_m_per_rad must be >= 0"},
      {[](auto& j) { j.goal_rad_least = 1, j.goal_rad_most = 0; }, "goal_rad_least must be below goal_rad_most"},
  };
  for (const auto& [change, refusal] : joints) {
    LeaderFacts facts = arm(3);
    change(facts.joints[1]);
    EXPECT_THAT(refusal_of(facts), HasSubstr(refusal));
  }
  const std::vector<std::pair<std::function<void(LeaderFacts&)>, std::string>> loops{
      {[](auto& f) { f.period_s = 1; }, "leader: period_s must be 0.0001 to 0.1, got 1"},
      {[](auto& f) { f.read_s_max = -1; }, "read_s_max must be >= 0"},
      {[](auto& f) { f.latency_s_max = 0; }, "latency_s_max must be at least read_s_max"},
      {[](auto& f) { f.hold_s_max = 0.004; }, "hold_s_max must be at least period_s and latency_s_max together"},
      {[](auto& f) { f.watchdog_s_least = 1; }, "watchdog_s_least must be 0 to hold_s_max"},
      {[](auto& f) { f.clock_share = 1; }, "clock_share must be >= 0 and < 1"},
      {[](auto& f) { f.memory_J = 0; }, "memory_J must be > 0"},
  };
  for (const auto& [change, refusal] : loops) {
    LeaderFacts facts = arm(3);
    change(facts);
    EXPECT_THAT(refusal_of(facts), HasSubstr(refusal));
  }
}

TEST(ForceBoundedLeader, RefusesGoalsOfAServoThatIsTooStiffAndSaysWhatItTakes) {
  LeaderFacts facts = arm(1);
  facts.joints[0].goal_stiffness_N_m_per_rad = 17.8;
  EXPECT_THAT(refusal_of(facts), AllOf(HasSubstr("goal_stiffness_N_m_per_rad must be at most 0.95"),
                                       HasSubstr("got 17.8"), HasSubstr("or torques")));
  facts.joints[0].goal_stiffness_N_m_per_rad = 0.9;
  EXPECT_EQ(refusal_of(facts), "accepted");
  facts.joints[0].torque_ripple_share = 0.01;
  EXPECT_THAT(refusal_of(facts), HasSubstr("torque_ripple_share must be 0 for goals"));
  facts.joints[0].torque_ripple_share = facts.joints[0].speed_rad_per_s_max = 0;
  EXPECT_THAT(refusal_of(facts), HasSubstr("speed_rad_per_s_max must be > 0 for goals"));
}

TEST(ForceBoundedLeader, AReadingThatIsLostCostsItsOwnJointTheTorqueAndNoOther) {
  Loop loop(arm(3));
  loop.warmed_up();
  const std::array<double, 3> position{loop.at_rad, kNaN, loop.at_rad + 6.28};  // the third wraps
  const std::array<double, 3> feedback{-1, -1, -1};
  loop.leader.step(position, feedback, 0.005, loop.torque_N_m);
  EXPECT_THAT(loop.torque_N_m, testing::ElementsAre(-1, 0, 0));
  EXPECT_THAT(loop.leader.fault_in_words(), HasSubstr("joint 'elbow': reading lost"));
  EXPECT_EQ(loop.leader.counts().readings_lost, 2U);
  loop.step(loop.at_rad += 0.005, -1, 0.005);
  EXPECT_THAT(loop.torque_N_m, Each(testing::Lt(0))) << "what was saved is not lost";
  EXPECT_EQ(loop.leader.fault_in_words(), "");
}

TEST(ForceBoundedLeader, WithoutFeedbackOrWithFeedbackThatIsNoNumberTorquesAreZero) {
  Loop loop(arm(2));
  loop.warmed_up();
  loop.step(loop.at_rad, kNaN, 0.005);
  EXPECT_THAT(loop.torque_N_m, Each(0));
  EXPECT_EQ(loop.leader.counts().feedback_not_finite, 2U);
  EXPECT_THAT(loop.leader.fault_in_words(), HasSubstr("feedback is not a number"));
  loop.step(loop.at_rad, -1, 0.005);
  EXPECT_THAT(loop.torque_N_m, Each(testing::Lt(0)));
  loop.leader.step(std::array{loop.at_rad, loop.at_rad}, {}, 0.005, loop.torque_N_m);
  EXPECT_THAT(loop.torque_N_m, Each(0));
  EXPECT_EQ(loop.leader.fault_in_words(), "");
}

/// Time that goes back, stands still or is no number: no torque until those before are over, and nothing is credited.
TEST(ForceBoundedLeader, AfterAnIntervalThatCannotBeTorquesAreZeroUntilThoseBeforeAreOver) {
  for (const double interval_s : {-0.005, 0.0, kNaN}) {
    SCOPED_TRACE(interval_s);
    Loop loop(arm(2));
    loop.warmed_up();
    const double energy_J = loop.leader.energy_J(0);
    EXPECT_THAT(loop.step(loop.at_rad += 0.5, -1, interval_s), Each(0));
    EXPECT_THAT(loop.leader.fault_in_words(), HasSubstr("none that a clock can have measured"));
    EXPECT_EQ(loop.leader.counts().intervals_impossible, 1U);
    EXPECT_LE(loop.leader.energy_J(0), energy_J);
    EXPECT_THAT(loop.step(loop.at_rad, -1, 0.005), Each(0)) << "its beginning is not believed";
    for (int n = 0; n < 10; ++n) loop.step(loop.at_rad += 0.005, -1, 0.005);
    EXPECT_THAT(loop.torque_N_m, Each(testing::Lt(0)));
  }
}

TEST(ForceBoundedLeader, CountsAStepAfterTheHoldTimeAsLateUnlessTheServosHaveAWatchdog) {
  Loop without(arm(2));
  without.warmed_up().step(without.at_rad, -1, 1.0);
  EXPECT_EQ(without.leader.counts().late, 1U);
  EXPECT_THAT(without.leader.fault_in_words(), HasSubstr("step later than hold_s_max, 0.011 s"));
  LeaderFacts facts = arm(2);
  facts.watchdog_s_least = 0.008;
  Loop with(facts);
  with.warmed_up().step(with.at_rad, -1, 1.0);
  EXPECT_EQ(with.leader.counts().late, 0U);
  EXPECT_EQ(with.leader.fault_in_words(), "");
}

TEST(ForceBoundedLeader, AfterAFailedWriteOrALostStepItHasNoMoreToSpend) {
  Loop loop(arm(2));
  loop.warmed_up();
  const double energy_J = loop.leader.energy_J(0);
  loop.leader.report_failed_write();
  loop.leader.lose(0.005);
  EXPECT_EQ(loop.leader.counts().writes_failed, 1U);
  EXPECT_EQ(loop.leader.counts().readings_lost, 2U);
  EXPECT_LT(loop.leader.energy_J(0), energy_J);
}

TEST(ForceBoundedLeader, GoalsAreReadingAndTorqueOverStiffnessInRangeAndStayAfterALostReading) {
  LeaderFacts facts = arm(2);
  LeaderJoint& joint = facts.joints[0];
  joint.goal_stiffness_N_m_per_rad = 0.5;
  joint.goal_rad_least = -0.4;
  const double step_rad = joint.encoder_step_rad;
  Loop loop(facts);
  EXPECT_TRUE(std::isnan(loop.leader.goal_rad(0)));
  double position_rad = 0;
  for (int n = 0; n < 300; ++n) loop.step(position_rad = n % 40 * step_rad, -1, 0.005);
  const double torque_N_m = loop.torque_N_m[0];
  EXPECT_LT(torque_N_m, 0);
  const double goal_rad = loop.leader.goal_rad(0);
  EXPECT_DOUBLE_EQ(goal_rad, position_rad + torque_N_m / 0.5);
  EXPECT_NEAR(goal_rad / step_rad, std::round(goal_rad / step_rad), 1e-9) << "a step of the servo's";
  EXPECT_GE(goal_rad, -0.4);
  EXPECT_TRUE(std::isnan(loop.leader.goal_rad(1))) << "takes torques";
  loop.step(kNaN, -1, 0.005);
  EXPECT_EQ(loop.leader.goal_rad(0), goal_rad);
  loop.step(-0.5, -1, 0.005);
  EXPECT_EQ(loop.leader.goal_rad(0), goal_rad) << "no goal in range makes zero torque there";
  EXPECT_EQ(loop.leader.counts().readings_lost, 4U) << "and the other joint cannot be there so soon";
}

/// What the hand gets from a servo that is a spring to its goal, told in closed form piece by piece: the opponent moves
/// the joint as the spring pulls, or at random, no faster than the facts say, and draws when goals act.
class SpringServo {
 public:
  SpringServo(const LeaderFacts& facts, unsigned seed) : facts_(facts), joint_(facts.joints[0]), random_(seed) {
    gain_ = drawn(1 - joint_.torque_gain_share, 1 + joint_.torque_gain_share);
  }

  double read() {
    move(drawn(0, facts_.read_s_max));
    return joint_.encoder_step_rad * std::round(at_rad_ / joint_.encoder_step_rad);
  }
  void write(double goal_rad) {
    move(drawn(0, facts_.latency_s_max - facts_.read_s_max));
    goal_rad_ = goal_rad;
    on_ = true;
  }
  void move(double time_s) {
    for (double left_s = time_s; left_s > 0; left_s -= kPiece_s) piece(std::min(left_s, kPiece_s));
    passed_s_ += time_s;
  }
  [[nodiscard]] double least_P_J() const { return least_P_J_; }
  [[nodiscard]] double passed_s() const { return passed_s_; }
  double drawn(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

 private:
  static constexpr double kPiece_s = 1e-3;

  void piece(double time_s) {
    const double k = on_ ? gain_ * joint_.goal_stiffness_N_m_per_rad : 0;
    const double pull_N_m = k * (goal_rad_ - at_rad_);
    if (drawn(0, 1) < 0.01) wild_ = drawn(0, 1) < 0.3 ? drawn(-1, 1) * joint_.speed_rad_per_s_max : 0;
    const double along = std::copysign(std::max(std::abs(pull_N_m) - joint_.friction_N_m, 0.0), pull_N_m) /
                         (2 * joint_.damping_N_m_s_per_rad);
    const double speed =
        std::clamp(wild_ != 0 ? wild_ : along, -joint_.speed_rad_per_s_max, joint_.speed_rad_per_s_max);
    const double next_rad = std::clamp(at_rad_ + speed * time_s, -3.0, 3.0);
    const double moved_rad = next_rad - at_rad_;
    // Work of the spring: k ((g - x_1)^2 - (g - x_2)^2) / 2.
    P_J_ += joint_.damping_N_m_s_per_rad * moved_rad * moved_rad / time_s + joint_.friction_N_m * std::abs(moved_rad) -
            k * moved_rad * (goal_rad_ - (at_rad_ + next_rad) / 2);
    at_rad_ = next_rad;
    least_P_J_ = std::min(least_P_J_, P_J_);
  }

  LeaderFacts facts_;
  LeaderJoint joint_;
  std::mt19937 random_;
  double gain_ = 1;
  double at_rad_ = 0;
  double goal_rad_ = 0;
  bool on_ = false;
  double wild_ = 0;
  double P_J_ = 0;
  double least_P_J_ = 0;
  double passed_s_ = 0;
};

TEST(ForceBoundedLeader, IsPassiveWithGoalsAgainstAHandThatMovesAsTheServoPulls) {
  LeaderFacts facts = arm(1, 60);
  facts.joints[0].speed_rad_per_s_max = 6;
  facts.joints[0].torque_gain_share = 0.1;
  facts.joints[0].goal_stiffness_N_m_per_rad = 0.9;
  double torques_N_m = 0;
  double least_with_J = 0;
  double least_without_J = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    for (const bool bounded : {true, false}) {
      Loop loop(facts);
      SpringServo servo(facts, seed);
      double before_s = 0;
      for (int n = 0; n < 1500; ++n) {
        const double stamp_s = servo.passed_s();
        const bool lost = servo.drawn(0, 1) < 0.02;
        const double read_rad = servo.read();
        const double wanted_N_m = servo.drawn(-1, 1) > 0 ? 1 : -1;
        loop.step(lost ? kNaN : read_rad, wanted_N_m, stamp_s - before_s);
        before_s = stamp_s;
        const double goal_rad = bounded ? loop.leader.goal_rad(0) : read_rad + wanted_N_m / 0.9;
        if (!std::isnan(goal_rad) && !(bounded && lost)) servo.write(goal_rad);
        torques_N_m += bounded ? std::abs(loop.torque_N_m[0]) : 0;
        servo.move(stamp_s + servo.drawn(1, 1.4) * facts.period_s - servo.passed_s());
      }
      double& least_J = bounded ? least_with_J : least_without_J;
      least_J = std::min(least_J, servo.least_P_J());
    }
  }
  EXPECT_GE(least_with_J, -1e-9);
  EXPECT_GT(torques_N_m, 100) << "of 30,000 steps";
  EXPECT_LT(least_without_J, -1);
}

TEST(ForceBoundedLeader, AStepDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Loop loop(arm(6));
  const std::array<double, 6> position{};
  const std::array<double, 6> feedback{1, 1, 1, kNaN, 1, 1};
  const test::AllocationGuard guard;
  for (int n = 0; n < 100; ++n) {
    loop.leader.step(position, feedback, n % 10 == 0 ? kNaN : 0.005, loop.torque_N_m);
    loop.leader.report_failed_write();
    if (n % 7 == 0) loop.leader.lose(0.005);
    (void)loop.leader.counts();
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::control
