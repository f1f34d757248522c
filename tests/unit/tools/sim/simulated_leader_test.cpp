#include "tests/tools/sim/simulated_leader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/special_numbers.hpp"
#include "tests/tools/sim/draw.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound::sim {
namespace {

using control::ForceBoundedLeader;
using control::LeaderFacts;
using control::Vector;
using namespace std::chrono_literals;

/// Joints of the order of an SO-101's, with each gear of it.
LeaderFacts small_arm(double rate_Hz) {
  LeaderFacts facts{.period_s = 1 / rate_Hz, .latency_s_max = 0.24 / rate_Hz, .read_s_max = 0.12 / rate_Hz};
  for (const double damping : {0.15, 0.48, 0.15, 0.09, 0.09, 0.09}) {
    facts.joints.push_back({.damping_N_m_s_per_rad = damping,
                            .friction_N_m = 0.02,
                            .encoder_step_rad = 0.0015339807878856,
                            .backlash_rad = 0.0174532925,
                            .torque_N_m_max = 1,
                            .torque_gain_share = 0.15,
                            .torque_ripple_share = 0.02,
                            .speed_rad_per_s_max = 60});
  }
  return facts;
}

struct Setting {
  double rate_Hz = 200;
  bool bounded = true;
  bool watchdog = false;     ///< then steps come up to 0.3 s late
  double lost_readings = 0;  ///< share
  double failed_writes = 0;  ///< share
  std::uint64_t seed = 1;
};

struct Outcome {
  double least_P_J = 0;
  double torque_share = 0;  ///< of what was asked for
  ForceBoundedLeader::Counts counts{};
};

/// Feedback is a spring to where the arm was a quarter of a second ago, with noise of 0.2 N m.
///
///     restless hand -- arm --readings--> [0.25 s] --> spring --feedback--> leader --torques--> arm
Outcome play(const Setting& setting) {
  LeaderFacts facts = small_arm(setting.rate_Hz);
  if (setting.watchdog) {
    facts.hold_s_max = 2.5 * facts.period_s;
    facts.watchdog_s_least = 1.5 * facts.period_s;
  }
  auto hand = std::make_unique<RestlessHand>(
      RestlessHand::Settings{.seed = setting.seed,
                             .degrees_of_freedom = 6,
                             .hand = {.mass_kg = 0.003, .stiffness_N_per_m = 5, .damping_N_s_per_m = 0.1},
                             .reach_m = 0.5,
                             .duration_s = 8});
  SimulatedLeader arm(facts, Vector::Constant(6, 0.02), std::move(hand), setting.seed);
  ForceBoundedLeader leader(facts);
  Draw draw(setting.seed);
  std::deque<Vector> past;
  Outcome outcome;
  double asked_N_m = 0;
  std::vector<double> given(6);
  Nanoseconds stamp{0};
  Nanoseconds before{0};
  while (stamp < 8s) {
    Vector read = arm.read(stamp);
    past.push_back(read);
    if (static_cast<double>(past.size()) > setting.rate_Hz / 4) past.pop_front();
    Vector feedback = 20 * (past.front() - read);
    for (double& one : feedback) one = std::clamp(one + draw.number(-0.2, 0.2), -1.0, 1.0);
    if (draw.number(0, 1) < setting.lost_readings) read[2] = test::kNaN;
    leader.step({read.data(), 6}, {feedback.data(), 6}, time::to_seconds(stamp - before), given);
    before = stamp;
    outcome.torque_share += Eigen::Map<Eigen::VectorXd>(given.data(), 6).lpNorm<1>();
    asked_N_m += feedback.lpNorm<1>();
    if (draw.number(0, 1) < setting.failed_writes) {
      leader.report_failed_write();
    } else {
      arm.write(stamp, setting.bounded ? Vector(Eigen::Map<Eigen::VectorXd>(given.data(), 6)) : feedback);
    }
    const bool late = setting.watchdog && draw.number(0, 1) < 0.02;
    stamp += time::from_seconds(facts.period_s * draw.number(1, 1.5) + (late ? draw.number(0, 0.3) : 0));
  }
  (void)arm.read(stamp);
  outcome.least_P_J = arm.audit().minimum_J;
  outcome.torque_share /= asked_N_m;
  outcome.counts = leader.counts();
  return outcome;
}

class LeaderAtRate : public ::testing::TestWithParam<double> {};

TEST_P(LeaderAtRate, IsPassiveWithJitterPlayAndFeedbackThatIsAQuarterSecondLate) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Outcome bounded = play({.rate_Hz = GetParam(), .seed = seed});
    EXPECT_GE(bounded.least_P_J, -1e-9);
    EXPECT_GT(bounded.torque_share, 0.05);
    EXPECT_EQ(bounded.counts.late, 0U);
    EXPECT_LT(play({.rate_Hz = GetParam(), .bounded = false, .seed = seed}).least_P_J, -0.1);
  }
}

TEST_P(LeaderAtRate, IsPassiveWithAWatchdogHoweverLateStepsAreAndWithLostReadingsAndFailedWrites) {
  const Outcome outcome = play({.rate_Hz = GetParam(), .watchdog = true, .lost_readings = 0.02, .failed_writes = 0.02});
  EXPECT_GE(outcome.least_P_J, -1e-9);
  EXPECT_GT(outcome.torque_share, 0.02);
  EXPECT_GT(outcome.counts.readings_lost, 0U);
  EXPECT_GT(outcome.counts.writes_failed, 0U);
}
INSTANTIATE_TEST_SUITE_P(Rates, LeaderAtRate, ::testing::Values(60, 200, 1000));

TEST(SimulatedLeader, RefusesWhatItCannotSimulate) {
  const auto refusal_of = [](const LeaderFacts& facts, Eigen::Index inertias) -> std::string {
    try {
      const SimulatedLeader arm(facts, Vector::Constant(inertias, 0.02),
                                std::make_unique<RestlessHand>(RestlessHand::Settings{.degrees_of_freedom = 6}));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  LeaderFacts facts = small_arm(200);
  EXPECT_THAT(refusal_of(facts, 5), testing::HasSubstr("inertia_kg_m2 must be > 0 for each of 6 joints"));
  facts.joints.push_back(facts.joints.front());
  EXPECT_THAT(refusal_of(facts, 7), testing::HasSubstr("1 to 6 joints, got 7"));
  facts = small_arm(200);
  facts.joints[3].torque_gain_share = 0;
  EXPECT_THAT(refusal_of(facts, 6), testing::HasSubstr("one torque_gain_share"));
}

}  // namespace
}  // namespace forcebound::sim
